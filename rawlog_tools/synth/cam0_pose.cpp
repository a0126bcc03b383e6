#include "cam0_pose.h"

#include "delio/core/geometry.h"

namespace delio::synth {
Eigen::Isometry3d cam0PoseOf(const Eigen::Isometry3d& lidar, const Eigen::Isometry3d& lidarToCam0) {
    const auto Tr = toMrpt(lidarToCam0);
    return fromMrpt(Tr + toMrpt(lidar) + (-Tr));
}

Eigen::Isometry3d lidarPoseOf(const Eigen::Isometry3d& cam0, const Eigen::Isometry3d& lidarToCam0) {
    const auto Tr = toMrpt(lidarToCam0);
    return fromMrpt((-Tr) + toMrpt(cam0) + Tr);
}
}  // namespace delio::synth
