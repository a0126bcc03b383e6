#pragma once
#include <Eigen/Geometry>

#include "road.h"

namespace delio::synth {
/** Half the distance between what touches the ground: front and rear, left and right. */
struct Footprint {
    double along_m, across_m;
};

/** Of a thing that stands on the road with four wheels (or feet), in the middle between them, on
 *  the ground: maps its coordinates (x ahead along the road, y left, z up) to the world's. */
Eigen::Isometry3d poseOnRoad(const Road& road, double s, double side_m, const Footprint& footprint);
}  // namespace delio::synth
