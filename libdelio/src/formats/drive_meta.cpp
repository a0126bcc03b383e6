#include "delio/formats/drive_meta.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
std::string quoted(const std::string& text) { return "'" + shortened(text, 60) + "'"; }

void take(const std::string& key, const std::string& text, double& value) {
    const auto number = numberIn<double>(text[0] == '+' ? text.substr(1) : text);
    if (!number) throw Error(key + " must be a number, not " + quoted(text));
    value = *number;
}

void take(const std::string& key, const std::string& text, bool& value) {
    if (text != "true" && text != "false")
        throw Error(key + " must be true or false, not " + quoted(text));
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
        throw Error("the key " + quoted(key) + " is not known");
}

DriveMeta metaOf(const YAML::Node& node) {
    if (!node.IsMap()) throw Error("expected 'key: value' lines");
    DriveMeta meta;
    std::set<std::string> keys;
    for (const auto& entry : node) {
        const auto key = entry.first.as<std::string>();
        if (!keys.insert(key).second) throw Error("the key " + quoted(key) + " appears twice");
        if (!entry.second.IsScalar() && !entry.second.IsNull())
            throw Error(quoted(key) + " must be a plain value");
        // A "~" in quotes is text, a bare one nothing.
        take(key, entry.second.IsNull() ? "" : entry.second.Scalar(), meta);
    }
    // Written so that a NaN fails as well.
    if (!(std::abs(meta.verticalCorrectionDeg) <= 5))
        throw Error("vertical_correction_deg must be from -5 to 5");
    if (!(meta.epoch_s >= 0 && meta.epoch_s < 1e10))
        throw Error("epoch_unix_s must be Unix seconds");
    return meta;
}
}  // namespace

SideFile sideFile(const std::string& path) {
    SideFile file{path, ""};
    if (!isFileThere(path)) return file;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || in.bad()) throw Error("cannot read '" + path + "': reading failed");
    file.text = text.str();
    return file;
}
std::string sidecarPath(const std::string& rawlogPath, const std::string& extension) {
    std::filesystem::path path(rawlogPath);
    return path.replace_extension().string() + extension;
}

std::optional<DriveMeta> readDriveMeta(const std::string& rawlogPath) {
    const std::string path = sidecarPath(rawlogPath, ".meta.yaml");
    if (!isFileThere(path)) return {};
    try {
        return metaOf(YAML::LoadFile(path));
    } catch (const std::exception& e) {
        throw Error("cannot parse '" + path + "': " + plainMessage(e));
    }
}

std::string textOf(const DriveMeta& meta) {
    YAML::Emitter yaml;
    const auto text = [&](const char* key, const std::string& value) {
        yaml << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << value;
    };
    yaml << YAML::Comment("Description of this drive; delio-slam reads it next to the rawlog.");
    yaml << YAML::BeginMap;
    text("sensor_model", meta.sensorModel);
    text("source", meta.source);
    yaml << YAML::Key << "motion_compensated" << YAML::Value << meta.motionCompensated;
    yaml << YAML::Key << "vertical_correction_deg" << YAML::Value
         << digitsOf(meta.verticalCorrectionDeg);
    yaml << YAML::Key << "epoch_unix_s" << YAML::Value << digitsOf(meta.epoch_s);
    text("generator", meta.generator);
    yaml << YAML::EndMap;
    return yaml.c_str() + std::string("\n");
}
}  // namespace delio::io
