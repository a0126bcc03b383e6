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

/** Those that a block's points are about. What is asked of the map first is asked of it for all of
 *  them before the next: memory is slow, and many places can be waited for at once. */
void Matcher::findPlanes(std::size_t block, const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    std::vector<std::size_t> moved;
    for (std::size_t i = block * kBlock; i < endOf(block); ++i) {
        const std::uint64_t voxel = map_.voxelAt(R * points_.col(static_cast<Eigen::Index>(i)) + t);
        if (voxel == latest_[i].voxel) continue;
        latest_[i].voxel = voxel;
        map_.prefetch(voxel);
        moved.push_back(i);
    }
    for (const std::size_t i : moved) map_.prefetchPlanes(latest_[i].voxel);
    for (const std::size_t i : moved) latest_[i].plane = map_.inVoxel(latest_[i].voxel);
}

Correspondences Matcher::matchesOf(std::size_t block, const Eigen::Isometry3d& pose,
                                   double kernel) const {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    Correspondences matches;
    matches.reserve(kBlock);
    for (std::size_t i = block * kBlock; i < endOf(block); ++i) {
        const Plane* plane = latest_[i].plane;
        if (!plane) continue;
        const Eigen::Vector3d point = points_.col(static_cast<Eigen::Index>(i));
        const Eigen::Vector3d placed = R * point + t;
        const double r = plane->normal().dot(placed - plane->mean);
        if (std::abs(r) > kReach * kernel) continue;
        const double robust = 1 / (1 + r * r / (kernel * kernel));
        matches.push_back(
            {point, plane->normal(), plane->mean,
             robust * robust / (plane->varianceAt(placed) + point_sigma_ * point_sigma_),
             plane->tilt()});
    }
    return matches;
}

Correspondences Matcher::at(const Eigen::Isometry3d& pose, double kernel) {
    std::vector<Correspondences> found(blocks());
    tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
        findPlanes(block, pose);
        found[block] = matchesOf(block, pose, kernel);
    });
    Correspondences all;
    all.reserve(latest_.size());
    for (const auto& matches : found) all.insert(all.end(), matches.begin(), matches.end());
    return all;
}

double Matcher::shareAt(const Eigen::Isometry3d& pose, double kernel) {
    tbb::parallel_for(std::size_t{0}, blocks(),
                      [&](std::size_t block) { findPlanes(block, pose); });
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < latest_.size(); ++i) {
        const Plane* plane = latest_[i].plane;
        if (!plane) continue;
        const Eigen::Vector3d placed = pose * points_.col(static_cast<Eigen::Index>(i));
        const double r = plane->normal().dot(placed - plane->mean) / kernel;
        sum += 1 / (1 + r * r);
        ++count;
    }
    return count > 0 ? sum / count : 0;
}
}  // namespace delio::planes
