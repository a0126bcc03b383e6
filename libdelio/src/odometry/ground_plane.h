#pragma once
#include <Eigen/Core>
#include <optional>

namespace delio::odometry {
/** The normal, a unit vector, of the ground of a scan (metres, the sensor at the origin), if it
 *  is tilted from `up`, the expected normal, by 10 to 65 deg: of the plane below the sensor that
 *  most points near it lie on, with nothing below. Nothing where a plane across `up` is about as
 *  large: a hill beside a road is not the ground. */
std::optional<Eigen::Vector3d> groundNormalOf(const Eigen::Matrix3Xf& points,
                                              const Eigen::Vector3d& up);
}  // namespace delio::odometry
