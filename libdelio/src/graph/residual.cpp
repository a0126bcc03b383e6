#include "graph/residual.h"

#include <Eigen/LU>
#include <cmath>

#include "core/portable_math.h"

namespace delio::graph {
Residual residualOf(const Eigen::Isometry3d& increment, const Eigen::Isometry3d& from,
                    const Eigen::Isometry3d& to) {
    const Eigen::Matrix3d Rz = increment.linear();
    const Eigen::Matrix3d Ri = from.linear();
    // (R, t) = T_from^-1 T_to, E = Z^-1 (R, t).
    const Eigen::Matrix3d R = Ri.transpose() * to.linear();
    const Eigen::Vector3d t = Ri.transpose() * (to.translation() - from.translation());
    const Eigen::Matrix3d Re = Rz.transpose() * R;

    Residual residual;
    residual.error << Rz.transpose() * (t - increment.translation()), rotationLog(Re);
    const Eigen::Matrix3d J = inverseRightJacobian(residual.error.tail<3>());
    residual.dTo << Re, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), J;
    residual.dFrom << -Rz.transpose(), Rz.transpose() * hat(t), Eigen::Matrix3d::Zero(),
        -J * R.transpose();
    return residual;
}

namespace {
/** d (tangent error) / d (the other's numbers). */
Matrix6 tangentBy(InformationOf terms, const Eigen::Isometry3d& pose) {
    Matrix6 K = Matrix6::Identity();
    if (terms == InformationOf::quaternion) K.bottomRightCorner<3, 3>() *= 2;
    if (terms == InformationOf::yawPitchRoll) {
        const auto angles = toMrpt(pose);
        const double sp = portable::sin(angles.pitch()), cp = portable::cos(angles.pitch());
        const double sr = portable::sin(angles.roll()), cr = portable::cos(angles.roll());
        K.topLeftCorner<3, 3>() = pose.linear().transpose();
        K.bottomRightCorner<3, 3>() << -sp, 0, 1, cp * sr, cr, 0, cp * cr, -sr, 0;
    }
    return K;
}
}  // namespace

Matrix6 convertInformation(const Matrix6& information, const Eigen::Isometry3d& pose,
                           InformationOf from, InformationOf to) {
    // e = K1 a = K2 b, so that a = K1^-1 K2 b.
    const Matrix6 K = tangentBy(from, pose).partialPivLu().solve(tangentBy(to, pose));
    const Matrix6 converted = K.transpose() * information * K;
    return (converted + converted.transpose()) / 2;
}
}  // namespace delio::graph
