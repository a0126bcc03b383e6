#include "delio/planes/plane_rotation.h"

#include <Eigen/Dense>

namespace delio::planes {
PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 double min_share) {
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
    // Directions that no normal looks along constrain nothing: the pseudo-inverse leaves them out.
    const Eigen::Matrix3d free = rt * tt.completeOrthogonalDecomposition().pseudoInverse();
    result.information = rr - free * rt.transpose();
    const Eigen::Vector3d gradient = gr - free * gt;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(result.information);
    for (int k = 0; k < 3; ++k) {
        if (!(axes.eigenvalues()[k] > min_share * axes.eigenvalues()[2])) continue;
        const Eigen::Vector3d axis = axes.eigenvectors().col(k);
        result.step -= axis * axis.dot(gradient) / axes.eigenvalues()[k];
    }
    return result;
}
}  // namespace delio::planes
