#pragma once
#include <Eigen/Geometry>

namespace delio::evaluation {
/** Angle of the rotation of `pose`, radians, 0 to pi: atan2(|skew part|, trace - 1) of the nearest
 *  rotation. The usual acos((trace - 1) / 2) loses half of the digits near 0, where the errors of
 *  an odometry lie. */
double rotationAngle_rad(const Eigen::Isometry3d& pose);
}  // namespace delio::evaluation
