#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include "delio/core/odometry_options.h"

#include "odometry/point_map.h"
#include "odometry/register_points.h"

namespace delio::odometry {
/** How far a guess of a pose may be off. */
struct SearchReach {
    double metres = 0;    //!< in the level plane
    double turn_rad = 0;  //!< about the vertical
};

/** Registration where `guess` may be off by `reach`. Long walls and guard rails fit at many places
 *  along them. So starts all over that disc are compared by those points alone that the guess does
 *  not explain. The disc is level where `upright` turns the points' frame such that z is up. */
PointEstimate searchPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& guess, const SearchReach& reach,
                           const Eigen::Matrix3f& upright, const PointRegistrationOptions& options);

/** Registration where a motion by `increment` a scan may have gone on from `latest` (sensor to map)
 *  for up to 30 scans, which are missing. */
PointEstimate searchOnward(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& latest, const Eigen::Isometry3d& increment,
                           const PointRegistrationOptions& options);

/** Registration where the rotation of `guess` may be off by up to `reach_rad` about any axis: by
 * the hand that carries the sensor, or a bump. Where a share of `enough` fits, no more is tried. */
PointEstimate searchTurns(const PointMap& map, const Eigen::Matrix3Xd& points,
                          const Eigen::Isometry3d& guess, double reach_rad, double enough,
                          const PointRegistrationOptions& options);

/** True where the points see that direction (a unit vector of the map's frame): the scan comes back
 *  to `pose` from `probe` metres along it to either side. (In a tunnel it stays where it was put.)
 */
bool pointsSee(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               const Eigen::Vector3d& axis, double probe, const PointRegistrationOptions& options);

/** Places in a level square: `steps` to either side of its middle, `step` metres apart. */
struct LevelSquare {
    const Eigen::Isometry3d& middle;  //!< sensor to map
    const Eigen::Matrix3f& upright;   //!< turns the sensor's z up
    double step = 1;
    int steps = 0;

    int side() const { return 2 * steps + 1; }  //!< places in a row
};

/** Counts of points; a row and a column of places are an x and a y, which rise. */
using LevelCounts = Eigen::Array<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic>;

/** From each place, how many points of the scan (metres, sensor's frame) come to lie within about
 *  half a step of one of the map's: by correlation over a grid (Olson, Real-time correlative scan
 *  matching, ICRA 2009). Of points far above or below the sensor none is counted. */
LevelCounts countsFrom(const LevelSquare& square, const PointMap& map,
                       const Eigen::Matrix3Xd& points);
}  // namespace delio::odometry
