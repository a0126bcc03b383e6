#pragma once
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace delio::map {
/** A point of a map, in the map's frame, with properties of the surface around it. */
struct MapPoint {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  //!< metres
    /** Unit surface normal towards the observer; 0 if unknown. */
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float intensity = 0;   //!< as measured by the sensor; 0 if unknown
    float time_s = 0;      //!< time of the first observation, since the drive's first scan
    float residual_m = 0;  //!< root mean square distance of the points about it from their plane
    std::uint16_t observations = 0;  //!< number of scans that hit its voxel; 0: unknown
};
/** All in one frame, the map's. */
using MapPoints = std::vector<MapPoint>;

/** Positions and intensities as MRPT has them, and the other way round. */
mrpt::maps::CPointsMapXYZI cloudOf(const MapPoints& points);
/** See cloudOf(); all else is not known. */
MapPoints pointsOf(const mrpt::maps::CPointsMap& cloud);

/** Each changes the points in place: a map may be as large as half of the memory. */

/** Gives positions and normals in another frame. */
void move(MapPoints& points, const Eigen::Isometry3d& otherFromMap);

/** Keeps what lies in the box, metres, its borders included. */
void crop(MapPoints& points, const Eigen::AlignedBox3d& box);

/** Keeps what lies up to `height` metres above the ground of `points` around it (their heights as
 *  ColourBy::Height shows them), of the dynamic points, too: a room without its ceiling. */
void cutAbove(MapPoints& points, MapPoints& dynamic, double height);

/** Keeps the first point in each voxel of `spacing` metres; 0: all. */
void thinOut(MapPoints& points, double spacing);
}  // namespace delio::map
