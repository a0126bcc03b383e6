#pragma once
#include <Eigen/Geometry>

#include "carrier.h"
#include "road.h"

namespace delio::synth {
/** Of a thing that stands on the road with four wheels (or feet), in the middle between them, on
 *  the ground: maps its coordinates (x ahead along the road, y left, z up) to the world's. */
Eigen::Isometry3d poseOnRoad(const Road& road, double s, double side_m, const Footprint& footprint);
}  // namespace delio::synth
