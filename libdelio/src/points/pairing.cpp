#include "pairing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace delio::points {
Pairing::Pairing(const PointMap& map, const Eigen::Matrix3Xd& points)
    : map_(map), points_(points), latest_(static_cast<std::size_t>(points.cols())) {}

/** Within `reach`, or one that is farther away. */
const PointMap::Nearest& Pairing::nearest(std::size_t point, const Eigen::Vector3d& placed,
                                          double reach) {
    constexpr double kRounding_m = 1e-3;  // distances are compared as floats
    // Farther than is asked now: where there is none, none has to be looked for again soon.
    constexpr double kFarthest = std::numeric_limits<double>::max();
    auto& [nearest, at] = latest_[point];
    const double away = nearest.any ? std::min(reach, (nearest.point - placed).norm()) : reach;
    const bool isStill = away + (placed - at).norm() + kRounding_m < nearest.others_m;
    if (!isStill) {
        nearest = map_.nearest(placed, kFarthest);
        at = placed;
    }
    return nearest;
}

Pairs Pairing::at(const Eigen::Isometry3d& pose, double kernel, Eigen::Index every) {
    constexpr double kReach = 3;  // kernel widths
    const double reach = kReach * kernel;
    Pairs pairs(static_cast<std::size_t>((points_.cols() + every - 1) / every));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              const Eigen::Index point = static_cast<Eigen::Index>(i) * every;
                              const Eigen::Vector3d placed = pose * points_.col(point);
                              const auto& found =
                                  nearest(static_cast<std::size_t>(point), placed, reach);
                              const double squared = (found.point - placed).squaredNorm();
                              if (!found.any || squared >= reach * reach) continue;
                              const double robust = 1 / (1 + squared / (kernel * kernel));
                              pairs[i] = {point, found.point, squared, robust * robust};
                          }
                      });
    return pairs;
}
}  // namespace delio::points
