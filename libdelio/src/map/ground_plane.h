#pragma once
#include <Eigen/Geometry>

#include "delio/map/map_point.h"

namespace delio::map {
/** The plane of the ground around a vehicle, its normal upwards, in the map's frame (frames.h says
 *  which one that is). Throws Error where there is none. */
Eigen::Hyperplane<double, 3> planeOfGround(const MapPoints& points,
                                           const Eigen::Isometry3d& vehicle);
}  // namespace delio::map
