#pragma once
#include <Eigen/Geometry>
#include <vector>
#include "delio/core/odometry_options.h"

#include "delio/core/geometry.h"
#include "odometry/point_map.h"

namespace delio::odometry {
/** A scan registered to the map of points. */
struct PointEstimate {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    /** Inlier ratio: of the points those within the last kernel of one of the map's, 0 to 1. */
    double inlierRatio = 0;
    double residual_m = 0;    //!< root mean square distance of these
    std::size_t matches = 0;  //!< pairs that it stands on
    unsigned iterations = 0;  //!< in all
    bool converged = false;   //!< false: ended by the most iterations that are allowed
    double kernel_m = 0;      //!< width that it began with
    /** False: too few correspondences, and the pose is the prediction; or too small a share. */
    bool valid = false;
};

/** Point-to-point registration, decoupled as the planes' is: each point is paired with the nearest
 *  one of the map. Pairs taken about their weighted centroids are free of the translation: they
 * give the rotation alone (SVD), and the centroids then the translation alone. With new pairs each
 * time, while the Geman-McClure kernel narrows from `kernel` (metres) to last_kernel. */
PointEstimate registerToPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Isometry3d& predicted, double kernel,
                               const PointRegistrationOptions& options);

/** The way from a to b, metres: of the sensor, in the map's frame, and of what it sees at a typical
 *  range, about its axes. */
Vector6 stepBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/** Share of the points that lie within `distance` (metres) of one of the map's, 0 to 1. A share
 *  below `least` may be returned as 0, which takes less time. */
double shareAt(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               double distance, double least = 0);

/** The points that do not. */
Eigen::Matrix3Xd pointsOff(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& pose, double distance);

/** A point of a scan, by its place in the order, with the nearest one of the map. */
struct Pair {
    Eigen::Index point = 0;
    Eigen::Vector3d inMap = Eigen::Vector3d::Zero();
    double squaredDistance = 0;
    double weight = 0;  //!< 0: none
};
using Pairs = std::vector<Pair>;

/** Pairs of a scan's points, again and again at poses that differ little: a point is looked for
 *  again only where it has moved so far that another one of the map may be the nearest. */
class Pairing {
 public:
    /** Map and points (the sensor's frame) have to stay as they are. */
    Pairing(const PointMap& map, const Eigen::Matrix3Xd& points);

    /** Of each `every`-th point. `kernel`: metres; pairs are at most three of them apart. */
    Pairs at(const Eigen::Isometry3d& pose, double kernel, Eigen::Index every = 1);

    const Eigen::Matrix3Xd& points() const { return points_; }

 private:
    /** What was found of a point, and where it was then. */
    struct Latest {
        PointMap::Nearest nearest;
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
    };
    static constexpr std::size_t kBlock = 64;
    static bool isStill(const Latest& latest, const Eigen::Vector3d& placed, double reach);
    void pairBlock(const Eigen::Isometry3d& pose, double kernel, Eigen::Index first,
                   Eigen::Index every, Pair* pairs, std::size_t count);

    const PointMap& map_;
    const Eigen::Matrix3Xd& points_;
    std::vector<Latest> latest_;
};
}  // namespace delio::odometry
