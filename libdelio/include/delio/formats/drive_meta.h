#pragma once
#include <optional>
#include <string>

namespace delio::io {
/** Text file next to a drive's scans, usually in one of KITTI's formats. */
struct SideFile {
    std::string name;  //!< file name for messages, even if the file is missing
    std::string text;  //!< empty: no file
};

/** Text of the file at `path`; empty if it does not exist. Throws Error if it cannot be read or is
 *  not a regular file. */
SideFile sideFile(const std::string& path);

/** Content of OUT.meta.yaml, the description of OUT.rawlog. */
struct DriveMeta {
    std::string sensorModel = "unknown";  //!< e.g. HDL-64E
    std::string source = "unknown";       //!< kitti-odometry | kitti-raw | synthetic
    bool motionCompensated = true;        //!< the recorder de-skewed each scan to its stamp
    double verticalCorrectionDeg = 0;     //!< to be added to every point's vertical angle
    double epoch_s = 0;                   //!< Unix time of second 0 of times.txt
    std::string generator;                //!< program and version that wrote the rawlog
};

/** `DRIVE.rawlog` and `.meta.yaml` give `DRIVE.meta.yaml`. */
std::string sidecarPath(const std::string& rawlogPath, const std::string& extension);

/** Reads the meta.yaml next to a rawlog (`key: value` lines); nothing if there is no file. Throws
 *  an Error that names the file for unknown or duplicate keys, invalid values and invalid YAML. */
std::optional<DriveMeta> readDriveMeta(const std::string& rawlogPath);
/** Text of a meta.yaml with all fields: what readDriveMeta() gives back equals `meta`. */
std::string textOf(const DriveMeta& meta);
}  // namespace delio::io
