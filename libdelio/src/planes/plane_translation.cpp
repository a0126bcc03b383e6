#include "delio/planes/plane_translation.h"

#include <Eigen/Dense>

namespace delio::planes {
PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    PlaneTranslation result;
    Eigen::Vector3d gradient = prior.translation * (t - prior.pose.translation());
    for (const auto& match : matches) {
        const Eigen::Vector3d& n = match.normal;
        const Eigen::Vector3d a = match.point.cross(R.transpose() * n);
        const Eigen::Matrix3d along = n * n.transpose();
        result.information += match.weight * along;
        result.pretended += match.weight * match.tilt * (Eigen::Matrix3d::Identity() - along);
        result.mixed += match.weight * n * a.transpose();
        result.weight += match.weight;
        gradient += match.weight * match.residual(R, t) * n;
    }
    const Eigen::Matrix3d all =
        result.information + prior.translation * Eigen::Matrix3d::Identity();
    result.step = -all.completeOrthogonalDecomposition().solve(gradient);
    return result;
}
}  // namespace delio::planes
