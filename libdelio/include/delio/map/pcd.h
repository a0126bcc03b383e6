#pragma once
#include <Eigen/Geometry>
#include <string>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"

namespace delio::map {
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
}  // namespace delio::map
