#pragma once
#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace delio::planes {
/** What is known of a pose (sensor to map) before the planes are asked. */
struct Prior {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map, metres
    double translation = 0;  //!< information along each axis, 1/m^2; 0: nothing is known
    /** Information, 1/rad^2, right tangent (sensor's frame). */
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();

    /** With a standard deviation of the translation along each axis, and the rotation's covariance.
     */
    static Prior of(const Eigen::Isometry3d& pose, double sigma_m,
                    const Eigen::Matrix3d& covariance_rad2) {
        return {pose, 1 / (sigma_m * sigma_m), covariance_rad2.inverse()};
    }
    /** In units of matches whose weights have this variance factor. */
    Prior times(double factor) const { return {pose, factor * translation, factor * rotation}; }
};
}  // namespace delio::planes
