#pragma once
#include <Eigen/Geometry>

namespace delio::planes {
/** What is known of a pose (sensor to map) before the planes are asked. */
struct Prior {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    double translation = 0;  //!< information along each axis, 1/m^2; 0: nothing is known
    /** Information about each axis of the sensor, 1/rad^2. */
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();

    static Prior of(const Eigen::Isometry3d& pose, double sigma_m,
                    const Eigen::Vector3d& sigma_rad) {
        return {pose, 1 / (sigma_m * sigma_m), sigma_rad.cwiseAbs2().cwiseInverse()};
    }
    /** In units of matches whose weights have this variance factor. */
    Prior times(double factor) const { return {pose, factor * translation, factor * rotation}; }
};
}  // namespace delio::planes
