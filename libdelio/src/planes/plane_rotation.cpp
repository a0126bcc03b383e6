#include "delio/planes/plane_rotation.h"

#include <Eigen/Dense>

#include "delio/core/geometry.h"

namespace delio::planes {
PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    Eigen::Matrix3d rr = Eigen::Matrix3d::Zero(), rt = rr, tt = rr;
    Eigen::Vector3d gr = Eigen::Vector3d::Zero(), gt = gr;
    PlaneRotation result;
    for (const auto& match : matches) {
        // d n.(R exp(w) p) / dw
        const Eigen::Vector3d a = match.point.cross(R.transpose() * match.normal);
        const Eigen::Vector3d& n = match.normal;
        const double r = match.weight * match.residual(R, t);
        rr += match.weight * a * a.transpose();
        rt += match.weight * a * n.transpose();
        tt += match.weight * n * n.transpose();
        gr += r * a;
        gt += r * n;
        result.weight += match.weight;
    }
    tt += prior.translation * Eigen::Matrix3d::Identity();
    gt += prior.translation * (t - prior.pose.translation());
    // Directions that no normal looks along constrain nothing: the pseudo-inverse leaves them out.
    const Eigen::Matrix3d free = rt * tt.completeOrthogonalDecomposition().pseudoInverse();
    result.information = rr - free * rt.transpose();
    const Eigen::Vector3d gradient =
        gr - free * gt + prior.rotation * rotationLog(prior.pose.linear().transpose() * R);
    const Eigen::Matrix3d all = result.information + prior.rotation;
    result.step = -all.completeOrthogonalDecomposition().solve(gradient);
    return result;
}
}  // namespace delio::planes
