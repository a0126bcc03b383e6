#pragma once
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace delio::evaluation {
/** A warning where many of these true poses (cam0, metres) are known to be wrong, else empty.
 *  Known are KITTI's official poses of the first 16 scans of sequence 00: they extrapolate one
 *  speed, 0.86 m a scan, where every odometry finds less. They are recognised by their positions,
 *  wherever they are in the file. `many`: more than 5 % of all. */
std::string knownFaultOf(const std::vector<Eigen::Isometry3d>& reference);
}  // namespace delio::evaluation
