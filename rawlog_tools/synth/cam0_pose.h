#pragma once
#include <Eigen/Geometry>

namespace delio::synth {
/** A pose of the LiDAR as one of KITTI's cam0, and back; `lidarToCam0` is KITTI's Tr. Composed by
 *  MRPT: another order of sums would change the last digits of what a seed stands for. */
Eigen::Isometry3d cam0PoseOf(const Eigen::Isometry3d& lidar, const Eigen::Isometry3d& lidarToCam0);
Eigen::Isometry3d lidarPoseOf(const Eigen::Isometry3d& cam0, const Eigen::Isometry3d& lidarToCam0);
}  // namespace delio::synth
