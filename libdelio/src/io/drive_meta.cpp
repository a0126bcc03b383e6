#include "delio/io/drive_meta.h"

#include <mrpt/containers/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>

#include "delio/error.h"
#include "delio/io/output_file.h"

namespace delio::io {
namespace {
const char* const kKeys[] = {"sensor_model",       "source",
                             "motion_compensated", "vertical_correction_deg",
                             "epoch_unix_s",       "generator"};
}  // namespace

std::string sidecarPath(const std::string& rawlogPath, const std::string& extension) {
    std::filesystem::path path(rawlogPath);
    return path.replace_extension().string() + extension;
}

std::optional<DriveMeta> readDriveMeta(const std::string& rawlogPath) {
    const std::string path = sidecarPath(rawlogPath, ".meta.yaml");
    if (!std::filesystem::exists(path)) return {};
    try {
        const auto yaml = mrpt::containers::yaml::FromFile(path);
        if (!yaml.isMap()) throw Error("it holds no 'key: value' lines");
        // A name with a slip would leave the default in place without a word.
        for (const auto& [key, value] : yaml.asMap())
            if (std::find(std::begin(kKeys), std::end(kKeys), key.as<std::string>()) ==
                std::end(kKeys))
                throw Error("the key '" + key.as<std::string>() + "' is not known");
        DriveMeta meta;
        meta.sensorModel = yaml.getOrDefault<std::string>("sensor_model", meta.sensorModel);
        meta.source = yaml.getOrDefault<std::string>("source", meta.source);
        meta.motionCompensated =
            yaml.getOrDefault<bool>("motion_compensated", meta.motionCompensated);
        meta.verticalCorrectionDeg =
            yaml.getOrDefault<double>("vertical_correction_deg", meta.verticalCorrectionDeg);
        meta.epoch_s = yaml.getOrDefault<double>("epoch_unix_s", meta.epoch_s);
        meta.generator = yaml.getOrDefault<std::string>("generator", meta.generator);
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
    mrpt::containers::yaml yaml = mrpt::containers::yaml::Map();
    yaml["sensor_model"] = meta.sensorModel;
    yaml["source"] = meta.source;
    yaml["motion_compensated"] = meta.motionCompensated;
    yaml["vertical_correction_deg"] = meta.verticalCorrectionDeg;
    yaml["epoch_unix_s"] = meta.epoch_s;
    yaml["generator"] = meta.generator;
    replaceTextFile(sidecarPath(rawlogPath, ".meta.yaml"), [&](std::ostream& out) {
        out << "# What this drive is; delio-slam reads it beside the rawlog.\n";
        yaml.printAsYAML(out);
        out << "\n";
    });
}
}  // namespace delio::io
