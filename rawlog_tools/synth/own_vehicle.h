#pragma once

namespace delio::synth {
/** The vehicle's own roof, bonnet and what stands on them hide what is below: as on KITTI's car.
 *  `azimuth_rad`: from ahead to the left; angles as the sensor sees them. */
bool behindOwnVehicle(double azimuth_rad, double elevation_rad);
}  // namespace delio::synth
