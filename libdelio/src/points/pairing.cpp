#include "pairing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

namespace delio::points {
Pairing::Pairing(const PointMap& map, const Eigen::Matrix3Xd& points)
    : map_(map), points_(points), latest_(static_cast<std::size_t>(points.cols())) {}

/** Whether what was found of it holds where it is now placed, within `reach`. */
bool Pairing::isStill(const Latest& latest, const Eigen::Vector3d& placed, double reach) {
    constexpr double kRounding_m = 1e-3;  // distances are compared as floats
    const auto& [nearest, at] = latest;
    const double away = nearest.any ? std::min(reach, (nearest.point - placed).norm()) : reach;
    return away + (placed - at).norm() + kRounding_m < nearest.others_m;
}

/** Of the points from `first` on, each `every`-th one. What is asked of the map first is asked of
 *  it for all of them before the next: memory is slow, and many places can be waited for at once.
 */
void Pairing::pairBlock(const Eigen::Isometry3d& pose, double kernel, Eigen::Index first,
                        Eigen::Index every, Pair* pairs, std::size_t count) {
    constexpr double kReach = 3;  // kernel widths
    // Farther than is asked now: where there is none, none has to be looked for again soon.
    constexpr double kFarthest = std::numeric_limits<double>::max();
    const double reach = kReach * kernel;
    std::array<Eigen::Vector3d, kBlock> placed;
    std::array<std::size_t, kBlock> moved;
    std::size_t movedCount = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Index point = first + static_cast<Eigen::Index>(i) * every;
        placed[i] = pose * points_.col(point);
        if (isStill(latest_[static_cast<std::size_t>(point)], placed[i], reach)) continue;
        moved[movedCount++] = i;
        map_.prefetch(placed[i]);
    }
    for (std::size_t k = 0; k < movedCount; ++k) map_.prefetchCell(placed[moved[k]]);
    for (std::size_t k = 0; k < movedCount; ++k) {
        const std::size_t i = moved[k];
        latest_[static_cast<std::size_t>(first + static_cast<Eigen::Index>(i) * every)] = {
            map_.nearest(placed[i], kFarthest), placed[i]};
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Index point = first + static_cast<Eigen::Index>(i) * every;
        const auto& found = latest_[static_cast<std::size_t>(point)].nearest;
        const double squared = (found.point - placed[i]).squaredNorm();
        if (!found.any || squared >= reach * reach) continue;
        const double robust = 1 / (1 + squared / (kernel * kernel));
        pairs[i] = {point, found.point, squared, robust * robust};
    }
}

Pairs Pairing::at(const Eigen::Isometry3d& pose, double kernel, Eigen::Index every) {
    Pairs pairs(static_cast<std::size_t>((points_.cols() + every - 1) / every));
    tbb::parallel_for(std::size_t{0}, (pairs.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
        const std::size_t first = block * kBlock;
        pairBlock(pose, kernel, static_cast<Eigen::Index>(first) * every, every,
                  pairs.data() + first, std::min(kBlock, pairs.size() - first));
    });
    return pairs;
}
}  // namespace delio::points
