#include "pairing.h"

#include <tbb/parallel_for.h>

namespace delio::points {
Pairing::Pairing(const PointMap& map, const Eigen::Matrix3Xd& points)
    : map_(map), points_(points), latest_(static_cast<std::size_t>(points.cols())) {}

/** False where the nearest one that was found last, or none, is so at another place, too. */
bool Pairing::hasLeft(const Latest& latest, const Eigen::Vector3d& placed, double reach) {
    constexpr double kRounding_m = 1e-3;  // distances are compared as floats
    const auto& nearest = latest.nearest;
    // Where there was none within reach, none has come so near.
    const double near = nearest.any ? (nearest.point - placed).norm() : reach;
    return near + (placed - latest.at).norm() + kRounding_m >= nearest.others_m;
}

/** The nearest ones of the points from `begin` to before `end`: within `reach`, or farther away. */
void Pairing::find(std::size_t begin, std::size_t end, const Eigen::Isometry3d& pose,
                   double reach) {
    std::vector<std::size_t> left;
    for (std::size_t i = begin; i < end; ++i) {
        const Eigen::Vector3d placed = pose * points_.col(static_cast<Eigen::Index>(i));
        if (!hasLeft(latest_[i], placed, reach)) continue;
        latest_[i].at = placed;
        map_.prefetch(placed);
        left.push_back(i);
    }
    for (const std::size_t i : left) map_.prefetchCell(latest_[i].at);
    for (const std::size_t i : left) latest_[i].nearest = map_.nearest(latest_[i].at, reach);
}

Pairs Pairing::at(const Eigen::Isometry3d& pose, double kernel) {
    constexpr double kReach = 3;  // kernel widths
    const double reach = kReach * kernel;
    Pairs pairs(latest_.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          find(range.begin(), range.end(), pose, reach);
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              const auto& found = latest_[i].nearest;
                              if (!found.any) continue;
                              const Eigen::Vector3d placed =
                                  pose * points_.col(static_cast<Eigen::Index>(i));
                              const double squared = (found.point - placed).squaredNorm();
                              if (squared >= reach * reach) continue;
                              const double robust = 1 / (1 + squared / (kernel * kernel));
                              pairs[i] = {found.point, squared, robust * robust};
                          }
                      });
    return pairs;
}
}  // namespace delio::points
