#include "delio/odometry/point_check.h"

#include <algorithm>
#include <cmath>

#include "delio/core/geometry.h"
#include "delio/points/point_search.h"
#include "delio/scan/voxel_grid.h"

namespace delio {
using points::PointEstimate;

std::vector<OptionField> PointCheckOptions::fields() const {
    using Me = PointCheckOptions;
    return {
        {"enabled", &Me::enabled, "false: lines and patterns are taken at their word"},
        {"believed", &Me::believed,
         "m; lines that lead farther than this from where points place the scan are not "
         "believed",
         0, 10},
        {"believed_deg", &Me::believed_deg, "deg; the same of the pattern's rotation", 0, 180},
        {"map_spacing", &Me::map_spacing, "m; points of the scan before are so far apart", 0.01,
         10},
        {"point_spacing", &Me::point_spacing, "m; points of the scan are so far apart", 0.01, 10},
        {"rest", &Me::rest,
         "m; points nearer than this to the scan before, were the vehicle at rest, say nothing",
         0.01, 10},
        {"min_moved", &Me::min_moved,
         "share of the points that have to be farther; with fewer they are not asked", 0, 1},
        {"min_share", &Me::min_share,
         "share of those that have to lie on points of the scan before in the place found", 0, 1},
        {"reach", &Me::reach, "m; motions are searched up to this", 0, 50}};
}

CheckPoints checkPointsOf(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                          const PointCheckOptions& options, const points::PointMapOptions& map) {
    CheckPoints check{{}, points::PointMap(map), upright};
    const Eigen::Matrix3Xf fine = scan::voxelCentroids(points, options.map_spacing);
    check.map.add(fine.cast<double>());
    check.points = scan::firstOfVoxels(fine, options.point_spacing).cast<double>();
    return check;
}

PointEstimate checkByPoints(const CheckPoints& from, const CheckPoints& to,
                            const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted,
                            double reach, const PointCheckOptions& options,
                            const points::PointRegistrationOptions& registration) {
    const auto& points = to.points;
    Eigen::Isometry3d rest = predicted;  // a rotation that was found may be off by much
    rest.translation().setZero();
    const auto moved = points::pointsOff(from.map, points, rest, options.rest);
    const auto shareOf = [&](const Eigen::Isometry3d& pose) {
        return points::shareAt(from.map, moved, pose, registration.last_kernel);
    };
    PointEstimate best;
    double most = 0;
    const auto compare = [&](const PointEstimate& placed) {
        const double share = placed.valid ? shareOf(placed.pose) : 0;
        if (share <= most) return;
        most = share;
        best = placed;
    };
    const double kernel = registration.least_kernel;
    compare(points::registerToPoints(from.map, points, found, kernel, registration));
    if (most < options.min_share || !agree(best.pose, found, options)) {
        compare(points::registerToPoints(from.map, points, predicted, kernel, registration));
        compare(points::searchPoints(from.map, points, rest, reach, to.upright, registration));
    }
    const auto least = options.min_moved * static_cast<double>(points.cols());
    best.valid = static_cast<double>(moved.cols()) >= least && most >= options.min_share &&
                 most > shareOf(found);
    return best;
}

bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
           const PointCheckOptions& options) {
    return (a.translation() - b.translation()).norm() <= options.believed &&
           angleOf(a.linear().transpose() * b.linear()) <= options.believed_deg * M_PI / 180;
}
}  // namespace delio
