#include "delio/planes/plane_translation.h"

#include <Eigen/Dense>

namespace delio::planes {
PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, double min_share) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    PlaneTranslation result;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const auto& match : matches) {
        const Eigen::Vector3d& n = match.normal;
        const Eigen::Vector3d a = match.point.cross(R.transpose() * n);
        result.information += match.weight * n * n.transpose();
        result.mixed += match.weight * n * a.transpose();
        result.weight += match.weight;
        gradient += match.weight * match.residual(R, t) * n;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(result.information);
    for (int k = 0; k < 3; ++k) {
        if (!(axes.eigenvalues()[k] > min_share * result.weight)) continue;
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        result.step -= axis * axis.dot(gradient) / axes.eigenvalues()[k];
    }
    return result;
}
}  // namespace delio::planes
