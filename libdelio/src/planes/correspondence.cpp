#include "delio/planes/correspondence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace delio::planes {
namespace {
/** Points farther from a plane than so many kernel widths do not belong to it. */
constexpr double kReach = 3;
}  // namespace

Matcher::Matcher(const PlaneMap& map, const Eigen::Matrix3Xd& points, double point_sigma)
    : map_(map),
      points_(points),
      point_sigma_(point_sigma),
      latest_(static_cast<std::size_t>(points.cols())) {}

/** Where a block's points are, and the planes about them. What is asked of the map first is asked
 * of it for all of them before the next: memory is slow, and many places can be waited for at once.
 */
Matcher::Placed Matcher::findPlanes(std::size_t block, const Eigen::Isometry3d& pose) {
    const std::size_t first = block * kBlock;
    Placed placed =
        pose.linear() * points_.middleCols(static_cast<Eigen::Index>(first),
                                           static_cast<Eigen::Index>(endOf(block) - first));
    placed.colwise() += pose.translation();
    std::vector<std::size_t> moved;
    for (std::size_t i = first; i < endOf(block); ++i) {
        const std::uint64_t voxel = map_.voxelAt(placed.col(static_cast<Eigen::Index>(i - first)));
        if (voxel == latest_[i].voxel) continue;
        latest_[i].voxel = voxel;
        map_.prefetch(voxel);
        moved.push_back(i);
    }
    for (const std::size_t i : moved) map_.prefetchPlanes(latest_[i].voxel);
    for (const std::size_t i : moved) latest_[i].plane = map_.inVoxel(latest_[i].voxel);
    return placed;
}

Correspondences Matcher::matchesOf(std::size_t block, const Placed& placed, double kernel) const {
    Correspondences matches;
    matches.reserve(kBlock);
    for (std::size_t i = block * kBlock; i < endOf(block); ++i) {
        const Plane* plane = latest_[i].plane;
        if (!plane) continue;
        const Eigen::Vector3d at = placed.col(static_cast<Eigen::Index>(i - block * kBlock));
        const double r = plane->normal().dot(at - plane->mean);
        if (std::abs(r) > kReach * kernel) continue;
        const double robust = 1 / (1 + r * r / (kernel * kernel));
        matches.push_back({points_.col(static_cast<Eigen::Index>(i)), plane->normal(), plane->mean,
                           robust * robust / (plane->varianceAt(at) + point_sigma_ * point_sigma_),
                           plane->tilt(), i});
    }
    return matches;
}

Correspondences Matcher::at(const Eigen::Isometry3d& pose, double kernel) {
    std::vector<Correspondences> found(blocks());
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        found[block] = matchesOf(block, findPlanes(block, pose), kernel);
    });
    Correspondences all;
    all.reserve(latest_.size());
    for (const auto& matches : found) all.insert(all.end(), matches.begin(), matches.end());
    return all;
}

double Matcher::shareAt(const Eigen::Isometry3d& pose, double kernel) {
    struct Share {
        double sum = 0, count = 0;
    };
    std::vector<Share> shares(blocks());
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        const Placed placed = findPlanes(block, pose);
        Share share;
        for (Eigen::Index i = 0; i < placed.cols(); ++i) {
            const Plane* plane = latest_[block * kBlock + static_cast<std::size_t>(i)].plane;
            if (!plane) continue;
            const double r = plane->normal().dot(placed.col(i) - plane->mean) / kernel;
            share.sum += 1 / (1 + r * r);
            ++share.count;
        }
        shares[block] = share;
    });
    Share all;
    for (const Share& share : shares) {
        all.sum += share.sum;
        all.count += share.count;
    }
    return all.count > 0 ? all.sum / all.count : 0;
}
}  // namespace delio::planes
