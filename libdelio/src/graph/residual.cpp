#include "delio/graph/residual.h"

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
}  // namespace delio::graph
