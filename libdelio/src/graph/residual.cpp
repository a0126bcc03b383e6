#include "delio/graph/residual.h"

#include <Eigen/Geometry>
#include <cmath>

namespace delio::graph {
namespace {
Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/** d log(exp(w) exp(d)) / d d at d = 0: the inverse of SO(3)'s right Jacobian. */
Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& w) {
    const double half = w.norm() / 2;
    const double c = half < 1e-4 ? 1.0 / 12 : (1 - half / std::tan(half)) / (4 * half * half);
    const Eigen::Matrix3d W = cross(w);
    return Eigen::Matrix3d::Identity() + W / 2 + c * W * W;
}

Eigen::Vector3d translationOf(const mrpt::poses::CPose3D& pose) {
    return {pose.x(), pose.y(), pose.z()};
}
}  // namespace

Residual residualOf(const mrpt::poses::CPose3D& increment, const mrpt::poses::CPose3D& from,
                    const mrpt::poses::CPose3D& to) {
    const Eigen::Matrix3d Rz = increment.getRotationMatrix().asEigen();
    const Eigen::Matrix3d Ri = from.getRotationMatrix().asEigen();
    const Eigen::Matrix3d Rj = to.getRotationMatrix().asEigen();
    // (R, t) = T_from^-1 T_to, E = Z^-1 (R, t).
    const Eigen::Matrix3d R = Ri.transpose() * Rj;
    const Eigen::Vector3d t = Ri.transpose() * (translationOf(to) - translationOf(from));
    const Eigen::Matrix3d Re = Rz.transpose() * R;
    const Eigen::AngleAxisd rotation(Re);

    Residual residual;
    residual.error << Rz.transpose() * (t - translationOf(increment)),
        rotation.angle() * rotation.axis();
    const Eigen::Matrix3d J = inverseRightJacobian(residual.error.tail<3>());
    residual.dTo << Re, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), J;
    residual.dFrom << -Rz.transpose(), Rz.transpose() * cross(t), Eigen::Matrix3d::Zero(),
        -J * R.transpose();
    return residual;
}
}  // namespace delio::graph
