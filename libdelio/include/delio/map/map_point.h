#pragma once
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace delio::map {
/** A point of a map, in the map's frame, and what is known of the surface about it. */
struct MapPoint {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  //!< metres
    /** Unit, on the side from which the point was seen; 0 where it is not known. */
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float intensity = 0;   //!< as the sensor gives it; 0 where there is none
    float time_s = 0;      //!< when it was seen first, since the drive's first scan
    float residual_m = 0;  //!< root mean square distance of the points about it from their plane
    std::uint16_t observations = 0;  //!< scans that saw something in its voxel; 0: not known
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

/** Keeps the first point in each voxel of `spacing` metres; 0: all. */
void thinOut(MapPoints& points, double spacing);
}  // namespace delio::map
