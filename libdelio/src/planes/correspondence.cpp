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

const Plane* Matcher::planeAbout(std::size_t point, const Eigen::Vector3d& placed) {
    Place& place = latest_[point];
    const std::uint64_t voxel = map_.voxelAt(placed);
    if (voxel != place.voxel) place = {voxel, map_.inVoxel(voxel)};
    return place.plane;
}

Correspondences Matcher::at(const Eigen::Isometry3d& pose, double kernel) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    Correspondences all(latest_.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, all.size(), 512),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const Eigen::Vector3d point = points_.col(static_cast<Eigen::Index>(i));
                const Eigen::Vector3d placed = R * point + t;
                const Plane* plane = planeAbout(i, placed);
                if (!plane) continue;
                const double r = plane->normal().dot(placed - plane->mean);
                if (std::abs(r) > kReach * kernel) continue;
                const double robust = 1 / (1 + r * r / (kernel * kernel));
                all[i] = {
                    point, plane->normal(), plane->mean,
                    robust * robust / (plane->varianceAt(placed) + point_sigma_ * point_sigma_),
                    plane->tilt()};
            }
        });
    all.erase(std::remove_if(all.begin(), all.end(),
                             [](const Correspondence& match) { return match.weight == 0; }),
              all.end());
    return all;
}

double Matcher::shareAt(const Eigen::Isometry3d& pose, double kernel) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < latest_.size(); ++i) {
        const Eigen::Vector3d placed = pose * points_.col(static_cast<Eigen::Index>(i));
        const Plane* plane = planeAbout(i, placed);
        if (!plane) continue;
        const double r = plane->normal().dot(placed - plane->mean) / kernel;
        sum += 1 / (1 + r * r);
        ++count;
    }
    return count > 0 ? sum / count : 0;
}
}  // namespace delio::planes
