#include "delio/planes/correspondence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace delio::planes {
namespace {
/** Points farther from a plane than so many kernel widths do not belong to it. */
constexpr double kReach = 3;
}  // namespace

Correspondences findCorrespondences(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                                    const Eigen::Isometry3d& pose, double kernel,
                                    double point_sigma) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    std::vector<Correspondence> all(static_cast<std::size_t>(points.cols()));
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, all.size(), 512),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const Eigen::Vector3d point = points.col(static_cast<Eigen::Index>(i));
                const Eigen::Vector3d placed = R * point + t;
                const Plane* plane = map.at(placed);
                if (!plane) continue;
                const double r = plane->normal().dot(placed - plane->mean);
                if (std::abs(r) > kReach * kernel) continue;
                const double robust = 1 / (1 + r * r / (kernel * kernel));
                all[i] = {point, plane->normal(), plane->mean,
                          robust * robust / (plane->varianceAt(placed) + point_sigma * point_sigma),
                          plane->tilt()};
            }
        });
    all.erase(std::remove_if(all.begin(), all.end(),
                             [](const Correspondence& match) { return match.weight == 0; }),
              all.end());
    return all;
}
}  // namespace delio::planes
