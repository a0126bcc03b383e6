#pragma once
#include <Eigen/Geometry>

namespace delio::planes {
/** What is known of a pose (sensor to map) before the planes are asked. */
struct Prior {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    double translation = 0;  //!< information along each axis, 1/m^2; 0: nothing is known
    double rotation = 0;     //!< information about each axis, 1/rad^2

    static Prior of(const Eigen::Isometry3d& pose, double sigma_m, double sigma_rad) {
        return {pose, 1 / (sigma_m * sigma_m), 1 / (sigma_rad * sigma_rad)};
    }
    /** In units of matches whose weights have this variance factor. */
    Prior times(double factor) const { return {pose, factor * translation, factor * rotation}; }
};
}  // namespace delio::planes
