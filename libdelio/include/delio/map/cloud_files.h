#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** Writes points as a binary little-endian PLY: float x y z (metres), nx ny nz, intensity, time
 *  (seconds), residual (metres), ushort observations, uchar red green blue. MRPT, CloudCompare and
 *  MeshLab read it. The same points give the same bytes. Throws Error if the file cannot be
 *  written, or the points do not have what they are to be coloured by.
 *  (MRPT's own exporter writes colours as grey, and does not notice a full disk.) */
void savePly(const MapPoints& points, const std::string& path, const Colouring& colouring = {});

/** Reads the vertices of a PLY, ascii or binary little-endian: x, y and z of any type, and whatever
 *  of nx ny nz, intensity, time, residual and observations is there; other properties are skipped,
 *  points that are not finite are dropped. Throws Error for a file that is missing, no such PLY, or
 *  cut off. */
MapPoints loadPly(const std::string& path);

/** Writes points as a binary PCD v0.7, as the Point Cloud Library reads it: float x y z (metres),
 *  normal_x normal_y normal_z, intensity, time (seconds), residual (metres), ushort observations,
 *  and rgb, packed into a float as PCL has it. The same points give the same bytes. Throws Error if
 *  the file cannot be written, or the points do not have what they are to be coloured by. */
void savePcd(const MapPoints& points, const std::string& path, const Colouring& colouring = {});

/** Reads a PCD, ascii or binary: x, y and z of any type, and whatever of the fields above is there;
 *  other fields and the viewpoint are skipped, points that are not finite are dropped. Throws Error
 *  for a file that is missing, no PCD, cut off, or compressed (binary_compressed). */
MapPoints loadPcd(const std::string& path);

/** The same, with the pose that VIEWPOINT says: x y z (metres), and the rotation as a quaternion w
 * x y z. Throws Error if it is missing or no pose, too. */
MapPoints loadPcd(const std::string& path, Eigen::Isometry3d& viewpoint);

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
