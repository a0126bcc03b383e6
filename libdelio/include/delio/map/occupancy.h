#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** What of a map is in the way of a vehicle. */
struct OccupancyOptions {
    double resolution_m = 0.1;   //!< edge of a cell
    double low_m = 0.3;          //!< above the ground: from here on something is in the way
    double height_m = 2.0;       //!< above the ground: from here on it is not
    double groundReach_m = 0.3;  //!< a point of the ground stands for cells as near as that
    double halfWidth_m = 0.5;    //!< of what the vehicle drove over, to either side of its way
};

/** The most cells that a grid may have. */
constexpr double kMostCells = 400e6;

/** A grid to plan ways with, from a map whose z is up. A cell is occupied if a point lies between
 *  `low_m` and `height_m` above the ground. It is free if there is ground and nothing on it, if the
 *  vehicle drove over it, or if a line of sight passes it no higher than `height_m` above the
 *  ground. All other cells are unknown (0.5). What a line of sight passes over and a point hits
 *  stays occupied. The ground is made of the low points around, and may rise by a half; what is
 *  steeper is in the way.
 *  @param ways poses of the vehicle in the map's frame, a list for each drive; may be empty
 *  @param sensor poses of the sensor in the map's frame, with stamps that count like
 *  MapPoint::time_s: lines of sight go from them to the points. Empty: there are none
 *  Throws Error where there are no points, or the grid would have more than kMostCells. */
mrpt::maps::COccupancyGridMap2D occupancyGrid(
    const MapPoints& points, const std::vector<std::vector<Eigen::Isometry3d>>& ways,
    const OccupancyOptions& options = {}, const io::Trajectory& sensor = {});

/** Writes MRPT's gzip-compressed .gridmap. Throws Error if that fails. */
void saveGridmap(const mrpt::maps::COccupancyGridMap2D& grid, const std::string& path);

/** The image that saveMapServer() puts beside `yaml`. */
std::string imageBeside(const std::string& yaml);

/** Writes the grid for ROS's map_server: `path`, a .yaml, and imageBeside() it a PGM whose first
 * row is the one of the largest y: 0 occupied, 254 free, 205 unknown. Both or, with an Error, none.
 */
void saveMapServer(const mrpt::maps::COccupancyGridMap2D& grid, const std::string& path);
}  // namespace delio::map
