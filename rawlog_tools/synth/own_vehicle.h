#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "ray_caster.h"

namespace delio::synth {
/** The vehicle's own roof, bonnet and what stands on them hide what is below: as on KITTI's car.
 *  `azimuth_rad`: from ahead to the left; angles as the sensor sees them. */
bool behindOwnVehicle(double azimuth_rad, double elevation_rad);

/** A part of the vehicle that the sensor sees: a box fixed to the first sensor. */
struct OwnBox {
    Eigen::AlignedBox3d box = {};                              //!< metres; empty: none
    Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();  //!< to the box's frame
};

/** Replaces hits behind the box. `local`: the rays' directions in the sensor's frame. */
void castOwnBox(const OwnBox& own, const std::vector<Eigen::Vector3d>& local,
                std::vector<Hit>& hits);
}  // namespace delio::synth
