#pragma once
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

namespace delio::io {
/** Poses of sensors in the vehicle, by the sensor's label. */
using Extrinsics = std::map<std::string, Eigen::Isometry3d>;

/** An IMU in the vehicle. */
struct ImuMount {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< IMU to vehicle
    std::optional<double> offset_s;                          //!< see ImuSample::offset_s
};

/** What a file of extrinsics says. */
struct ExtrinsicsFile {
    Extrinsics lidars;
    std::optional<ImuMount> imu;
};

/** Reads lines `LABEL x y z yaw pitch roll` of LiDARs (metres and degrees, in MRPT's order), and
 *  perhaps one `imu x y z yaw pitch roll [offset]` (the latter in seconds); `#` begins a comment.
 *  Throws Error, which names the line, where it is something else, or nothing. */
ExtrinsicsFile readExtrinsics(const std::string& path);

/** Such lines, without their end. */
std::string extrinsicsLine(const std::string& label, const Eigen::Isometry3d& pose);
std::string extrinsicsLine(const ImuMount& imu);
}  // namespace delio::io
