#include "standstill.h"

#include <algorithm>
#include <cmath>

namespace delio {
namespace {
/** Surfaces that face an axis: what they say about a motion along it. */
struct Facing {
    Eigen::Matrix3Xd points, normals;  //!< map's frame
    bool isAllAround = false;          //!< not to one side of the sensor only
};

Facing facing(const surfaces::SurfaceNormals& scan, const Eigen::Isometry3d& pose,
              const Eigen::Vector3d& axis) {
    constexpr double kFacing = 0.5;    // cosine: within 60 deg
    constexpr double kOneSided = 0.8;  // length of the mean direction: 1 for a single direction
    const Eigen::Index all = scan.directions.cols();
    Facing found{Eigen::Matrix3Xd(3, all), Eigen::Matrix3Xd(3, all)};
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < all; ++i) {
        const Eigen::Vector3d normal = pose.linear() * scan.directions.col(i).cast<double>(),
                              point = scan.points.col(i).cast<double>();
        if (std::abs(normal.dot(axis)) < kFacing) continue;
        found.normals.col(kept) = normal;
        found.points.col(kept++) = pose * point;
        direction += point.normalized();
    }
    found.normals.conservativeResize(3, kept);
    found.points.conservativeResize(3, kept);
    found.isAllAround = direction.norm() < kOneSided * static_cast<double>(kept);
    return found;
}

/** How the surfaces, moved by `offset`, lie on the map. */
struct Fit {
    double ratio = 0;    //!< of them within reach, 0 to 1
    double shift_m = 0;  //!< along the axis that brings them onto the map's points, least squares
};

Fit fitOf(const points::PointMap& map, const Facing& surfaces, const Eigen::Vector3d& axis,
          const Eigen::Vector3d& offset, double reach) {
    double near = 0, weights = 0, moments = 0;
    for (Eigen::Index i = 0; i < surfaces.points.cols(); ++i) {
        const Eigen::Vector3d point = surfaces.points.col(i) + offset,
                              normal = surfaces.normals.col(i);
        const auto nearest = map.nearest(point, reach);
        if (!nearest.any) continue;
        const double along = normal.dot(axis);
        ++near;
        weights += along * along;
        moments += along * normal.dot(nearest.point - point);
    }
    return {near / static_cast<double>(surfaces.points.cols()),
            weights > 0 ? moments / weights : 0};
}
}  // namespace

bool showsStandstill(const points::PointMap& map, const surfaces::SurfaceNormals& scan,
                     const Eigen::Isometry3d& pose, const StandstillTest& test) {
    // Where a single far ring turns from the ground to a wall, it looks like a surface across the
    // road: in a smooth corridor up to 1 % of all surfaces.
    constexpr double kFewest = 20, kFewestOfAll = 0.02;
    constexpr double kMatched = 0.5, kGone = 0.5, kStill_m = 0.02;
    const Facing surfaces = facing(scan, pose, test.axis);
    const auto count = static_cast<double>(surfaces.points.cols()),
               all = static_cast<double>(scan.directions.cols());
    if (count < std::max(kFewest, kFewestOfAll * all) || !(surfaces.isAllAround || test.isVertical))
        return false;
    const auto fitAt = [&](double along_m) {
        return fitOf(map, surfaces, test.axis, along_m * test.axis, test.reach);
    };
    const Fit here = fitAt(0);
    const double elsewhere = std::max(fitAt(test.probe).ratio, fitAt(-test.probe).ratio);
    return here.ratio >= kMatched && elsewhere <= kGone * here.ratio &&
           std::abs(here.shift_m) <= kStill_m;
}
}  // namespace delio
