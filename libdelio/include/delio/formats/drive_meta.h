#pragma once
#include <optional>
#include <string>

namespace delio::io {
/** What lies beside a drive's scans: a text, most often in one of KITTI's formats. */
struct SideFile {
    std::string name;  //!< of the file, for messages; also where there is none
    std::string text;  //!< empty: there is none
};

/** The text of the file at `path`; none where there is no such file. Throws Error where it cannot
 *  be read, or where something else than a file is there. */
SideFile sideFile(const std::string& path);

/** What OUT.meta.yaml says of the drive in OUT.rawlog. */
struct DriveMeta {
    std::string sensorModel = "unknown";  //!< e.g. HDL-64E
    std::string source = "unknown";       //!< kitti-odometry | kitti-raw | synthetic
    bool motionCompensated = true;        //!< the recorder brought each scan to its stamp
    double verticalCorrectionDeg = 0;     //!< to be added to every point's vertical angle
    double epoch_s = 0;                   //!< Unix time of second 0 of times.txt
    std::string generator;                //!< program and version that wrote the rawlog
};

/** `DRIVE.rawlog` and `.meta.yaml` give `DRIVE.meta.yaml`. */
std::string sidecarPath(const std::string& rawlogPath, const std::string& extension);

/** The meta.yaml beside a rawlog, a `key: value` a line; nothing if there is none. Throws Error,
 *  which names the file, for an unknown key, one that is there twice, a value that is not of its
 *  key's kind or is out of range, or anything else that cannot be understood. */
std::optional<DriveMeta> readDriveMeta(const std::string& rawlogPath);
/** The text of a meta.yaml with all of it: what readDriveMeta() gives back equals `meta`. */
std::string textOf(const DriveMeta& meta);
}  // namespace delio::io
