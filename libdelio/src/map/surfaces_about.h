#pragma once
#include "delio/map/map_point.h"

namespace delio::map {
/** Gives each point the normal and the residual of the plane through the points about it (those in
 *  its voxel's neighbourhood, one a voxel of `spacing` metres; 0: of 0.2). Its normal says before
 *  towards which side it has to point; it is 0 afterwards where too few points are about. */
void findSurfaces(MapPoints& points, double spacing);
}  // namespace delio::map
