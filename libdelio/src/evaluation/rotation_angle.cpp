#include "delio/evaluation/rotation_angle.h"
#include "core/portable_math.h"

#include <Eigen/Dense>
#include <cmath>

namespace delio::evaluation {
double rotationAngle_rad(const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d nearly = pose.linear();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(nearly, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
    const Eigen::Vector3d skew(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    return portable::atan2(skew.norm(), R.trace() - 1);  // 2 sin, 2 cos
}
}  // namespace delio::evaluation
