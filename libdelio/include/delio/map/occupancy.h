#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** Obstacles of a map. */
struct OccupancyOptions {
    double resolution_m = 0.1;   //!< edge of a cell
    double low_m = 0.3;          //!< above the ground: lower end of obstacles
    double height_m = 2.0;       //!< above the ground: upper end of obstacles
    double groundReach_m = 0.3;  //!< radius of cells around a ground point that count as ground
    double halfWidth_m = 0.5;    //!< half width of the vehicle's path
};

/** Maximum number of cells. */
constexpr double kMostCells = 400e6;

/** Occupancy grid of a map whose z axis points up. A cell is occupied if a point lies between
 *  `low_m` and `height_m` above the ground. It is free if there is ground and nothing on it, if the
 *  vehicle drove over it, or if a line of sight passes it no higher than `height_m` above the
 *  ground. All other cells are unknown (0.5). A cell with an obstacle stays occupied even if a line
 *  of sight passes over it. The ground consists of the lowest points around a cell and may have a
 *  slope of up to 1/2; anything steeper is an obstacle.
 *  @param ways poses of the vehicle in the map's frame, a list for each drive; may be empty
 *  @param sensor poses of the sensor in the map's frame, with stamps that count like
 *  MapPoint::time_s: lines of sight go from them to the points. Empty: no lines of sight Throws
 *  Error where there are no points, or the grid would have more than kMostCells. */
mrpt::maps::COccupancyGridMap2D occupancyGrid(
    const MapPoints& points, const std::vector<std::vector<Eigen::Isometry3d>>& ways,
    const OccupancyOptions& options = {}, const io::Trajectory& sensor = {});

/** Writes MRPT's gzip-compressed .gridmap. Throws Error if that fails. */
void saveGridmap(const mrpt::maps::COccupancyGridMap2D& grid, const std::string& path);

/** Path of the image that saveMapServer() writes next to `yaml`. */
std::string imageBeside(const std::string& yaml);

/** Writes the grid for ROS's map_server: `path`, a .yaml, and imageBeside() it a PGM whose first
 * row is the one of the largest y: 0 occupied, 254 free, 205 unknown. Both or, with an Error, none.
 */
void saveMapServer(const mrpt::maps::COccupancyGridMap2D& grid, const std::string& path);
}  // namespace delio::map
