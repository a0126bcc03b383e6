#pragma once
#include <Eigen/Geometry>
#include <map>
#include <string>

namespace delio::io {
/** Poses of sensors in the vehicle, by the sensor's label. */
using Extrinsics = std::map<std::string, Eigen::Isometry3d>;

/** Reads lines `LABEL x y z yaw pitch roll` (metres and degrees, in MRPT's order); `#` begins a
 *  comment. Throws Error, which names the line, where it is something else. */
Extrinsics readExtrinsics(const std::string& path);

/** Such a line, without its end. */
std::string extrinsicsLine(const std::string& label, const Eigen::Isometry3d& pose);
}  // namespace delio::io
