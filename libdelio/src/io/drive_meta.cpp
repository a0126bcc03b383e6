#include "delio/io/drive_meta.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>

#include "delio/error.h"
#include "delio/io/output_file.h"
#include "flat_yaml.h"

namespace delio::io {
namespace {
void take(const std::string& key, const std::string& text, double& value) {
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + (text[0] == '+' ? 1 : 0), end, value);
    if (result.ec != std::errc() || result.ptr != end)
        throw Error(key + " has to be a number, not '" + text + "'");
}

void take(const std::string& key, const std::string& text, bool& value) {
    if (text != "true" && text != "false")
        throw Error(key + " has to be true or false, not '" + text + "'");
    value = text == "true";
}

/** A name with a slip would leave the default in place without a word: it is refused. */
void take(const std::string& key, const std::string& text, DriveMeta& meta) {
    if (key == "sensor_model")
        meta.sensorModel = text;
    else if (key == "source")
        meta.source = text;
    else if (key == "motion_compensated")
        take(key, text, meta.motionCompensated);
    else if (key == "vertical_correction_deg")
        take(key, text, meta.verticalCorrectionDeg);
    else if (key == "epoch_unix_s")
        take(key, text, meta.epoch_s);
    else if (key == "generator")
        meta.generator = text;
    else
        throw Error("the key '" + key + "' is not known");
}

/** The digits that give the same double back. */
std::string digitsOf(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}
}  // namespace

std::string sidecarPath(const std::string& rawlogPath, const std::string& extension) {
    std::filesystem::path path(rawlogPath);
    return path.replace_extension().string() + extension;
}

std::optional<DriveMeta> readDriveMeta(const std::string& rawlogPath) {
    const std::string path = sidecarPath(rawlogPath, ".meta.yaml");
    if (!std::filesystem::exists(path)) return {};
    try {
        std::ifstream in(path, std::ios::binary);
        std::ostringstream text;
        if (!(text << in.rdbuf())) throw Error("it is empty, or not readable");
        DriveMeta meta;
        for (const auto& [key, value] : readFlatYaml(text.str())) take(key, value, meta);
        // Written so that a NaN fails as well.
        if (!(std::abs(meta.verticalCorrectionDeg) <= 5))
            throw Error("vertical_correction_deg has to be from -5 to 5");
        if (!(meta.epoch_s >= 0 && meta.epoch_s < 1e10))
            throw Error("epoch_unix_s has to be Unix seconds");
        return meta;
    } catch (const std::exception& e) {
        throw Error("cannot understand '" + path + "': " + plainMessage(e));
    }
}

void writeDriveMeta(const DriveMeta& meta, const std::string& rawlogPath) {
    replaceTextFile(sidecarPath(rawlogPath, ".meta.yaml"), [&](std::ostream& out) {
        out << "# What this drive is; delio-slam reads it beside the rawlog.\n";
        out << "sensor_model: " << quotedForYaml(meta.sensorModel) << "\n"
            << "source: " << quotedForYaml(meta.source) << "\n"
            << "motion_compensated: " << (meta.motionCompensated ? "true" : "false") << "\n"
            << "vertical_correction_deg: " << digitsOf(meta.verticalCorrectionDeg) << "\n"
            << "epoch_unix_s: " << digitsOf(meta.epoch_s) << "\n"
            << "generator: " << quotedForYaml(meta.generator) << "\n";
    });
}
}  // namespace delio::io
