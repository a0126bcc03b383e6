#include "map/motion_labels.h"

#include <cmath>

#include "core/voxel_grid.h"

namespace delio::map {
std::vector<std::uint8_t> MotionLabels::of(const Eigen::Matrix3Xf& points,
                                           const Eigen::Isometry3d& sensorInWorld, double time_s) {
    constexpr double kVoxel_m = 0.2;
    std::vector<std::uint8_t> labels(static_cast<std::size_t>(points.cols()));
    if (!(time_s > latest_s_)) return labels;
    latest_s_ = time_s;
    const auto numbers = numberVoxels(points, kVoxel_m);
    const Eigen::Vector3d ahead = sensorInWorld.linear().col(0);
    const Eigen::Isometry3d levelInWorld =
        Eigen::Translation3d(sensorInWorld.translation()) *
        Eigen::AngleAxisd(std::atan2(ahead.y(), ahead.x()), Eigen::Vector3d::UnitZ());
    const Eigen::Matrix3d upright = levelInWorld.linear().transpose() * sensorInWorld.linear();
    const auto voxels =
        objects_.detect(objects_.see(centroidsOf(points, numbers), objects_.freeSpaceOf(points),
                                     upright.cast<float>()),
                        levelInWorld, time_s);
    objects_.remember(levelInWorld);
    for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = voxels[numbers.ofPoint[i]];
    return labels;
}
}  // namespace delio::map
