#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "delio/earth/georeference.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** A frame that stands level on the ground: maps the map's coordinates to those above the plane of
 *  the ground around `firstPose` (the vehicle's, in the map). z is along the plane's normal and 0
 * on the ground under that pose; x is the map's x along the plane, so that directions on the ground
 *  stay as they are; and so do x and y of that pose. The plane is the one, within 30 degrees of
 *  the vehicle's own, that most points within 10 m lie on; not above the vehicle. Throws Error
 * where there is no ground. The same points give the same frame. */
Eigen::Isometry3d groundFrame(const MapPoints& points, const Eigen::Isometry3d& firstPose);

/** Geographic position and heading of the vehicle at the first pose. */
struct GeoReference {
    double latitude_deg = 0;   //!< WGS84, north positive
    double longitude_deg = 0;  //!< WGS84, east positive
    double altitude_m = 0;     //!< above the WGS84 ellipsoid
    double heading_deg = 0;  //!< of the vehicle's x axis, from north, clockwise as seen from above
};

/** Maps the map's coordinates to east, north and up, in metres from where the vehicle was first. Up
 *  is the ground's normal there; throws Error as groundFrame() does. */
Eigen::Isometry3d enuFrame(const MapPoints& points, const Eigen::Isometry3d& firstPose,
                           double heading_deg);

/** Maps east, north and up of that place to the earth's own frame (ECEF, WGS84), metres. */
Eigen::Isometry3d ecefFromEnu(const GeoReference& place);

/** Writes a YAML with the transformation from a map's frame to another one, as four rows of four
 *  numbers of 17 digits, and, with a place on the earth, its coordinates and ecefFromEnu(). Throws
 *  Error if that fails. */
void saveFrame(const Eigen::Isometry3d& otherFromMap, const std::optional<GeoReference>& place,
               const std::string& path);

/** Writes a YAML with the zone (EPSG code) and offset of a map that earth::MapToUtm brought into
 *  UTM, and its georeference. Throws Error if that fails. */
void saveUtmFrame(const earth::Georeference& place, const std::string& path);
}  // namespace delio::map
