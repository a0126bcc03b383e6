#include "pairing.h"

#include <tbb/parallel_for.h>

namespace delio::points {
Pairing::Pairing(const PointMap& map, const Eigen::Matrix3Xd& points)
    : map_(map), points_(points), latest_(static_cast<std::size_t>(points.cols())) {}

/** Within `reach`, or one that is farther away. */
const PointMap::Nearest& Pairing::nearest(std::size_t point, const Eigen::Vector3d& placed,
                                          double reach) {
    constexpr double kRounding_m = 1e-3;  // distances are compared as floats
    auto& [nearest, at] = latest_[point];
    const bool isStill =
        nearest.any &&
        (nearest.point - placed).norm() + (placed - at).norm() + kRounding_m < nearest.others_m;
    if (!isStill) {
        nearest = map_.nearest(placed, reach);
        at = placed;
    }
    return nearest;
}

Pairs Pairing::at(const Eigen::Isometry3d& pose, double kernel) {
    constexpr double kReach = 3;  // kernel widths
    const double reach = kReach * kernel;
    Pairs pairs(latest_.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              const Eigen::Vector3d placed =
                                  pose * points_.col(static_cast<Eigen::Index>(i));
                              const auto& found = nearest(i, placed, reach);
                              const double squared = (found.point - placed).squaredNorm();
                              if (!found.any || squared >= reach * reach) continue;
                              const double robust = 1 / (1 + squared / (kernel * kernel));
                              pairs[i] = {found.point, squared, robust * robust};
                          }
                      });
    return pairs;
}
}  // namespace delio::points
