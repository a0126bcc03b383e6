#pragma once
#include <Eigen/Geometry>

#include "delio/map/map_point.h"

namespace delio::map {
/** Each changes the points in place: a map may be as large as half of the memory. */

/** Gives positions and normals in another frame. */
void move(MapPoints& points, const Eigen::Isometry3d& otherFromMap);

/** Keeps what lies in the box, metres, its borders included. */
void crop(MapPoints& points, const Eigen::AlignedBox3d& box);

/** Keeps the first point in each voxel of `spacing` metres; 0: all. */
void thinOut(MapPoints& points, double spacing);
}  // namespace delio::map
