#pragma once
#include <Eigen/Geometry>
#include <cstdint>

#include "delio/points/point_map.h"

namespace delio::points {
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
}  // namespace delio::points
