#pragma once
#include <functional>
#include <optional>
#include <string>

#include "delio/map/map_point.h"

namespace delio::map {
/** Where and when the points of a map are. */
struct LasPlace {
    /** Maps the map's coordinates to those of the file; empty: they are the same. */
    std::function<Eigen::Vector3d(const Eigen::Vector3d& point)> coordinatesOf;
    std::string wkt;                         //!< coordinate system of the file; empty: local
    std::optional<double> firstScan_unix_s;  //!< time of the drive's first scan, if it is known
};

/** Writes points as LAS 1.4, point format 6: coordinates in steps of 0.1 mm, intensity (values up
 *  to 1 times 65535, up to 255 times 256), return 1 of 1, classification 2 (ground) or 1, GPS time
 *  (adjusted standard, where the time of the first scan is known; else seconds since it), and as
 *  extra bytes observations, residual and normal. The map's z has to point up for the ground to be
 *  found. The same points give the same bytes. Throws Error if the file cannot be written. */
void saveLas(const MapPoints& points, const std::string& path, const LasPlace& place = {});

/** A map of a LAS file. */
struct LasMap {
    MapPoints points;  //!< relative to `offset`; times since the earliest point
    /** The file's coordinates of the points' zero, whole kilometres: 0 where the file's own
     *  are small enough for the points' floats. */
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    std::string wkt;  //!< coordinate system of the file; empty: none
};

/** Reads LAS 1.0 to 1.4: positions, intensities, times, and whatever of the extra bytes above is
 *  there. Throws Error for a file that is missing, no LAS, compressed, cut off, or contradicts
 *  itself. */
LasMap loadLas(const std::string& path);
}  // namespace delio::map
