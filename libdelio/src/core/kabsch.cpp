#include "delio/core/kabsch.h"

#include <Eigen/Dense>

namespace delio {
Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& moment) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, 1);
    sign[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}
}  // namespace delio
