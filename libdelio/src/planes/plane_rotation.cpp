#include "delio/planes/plane_rotation.h"

#include <Eigen/Dense>

#include "delio/core/geometry.h"
#include "sum_over.h"

namespace delio::planes {
namespace {
/** Of each match's derivatives by rotation and by translation, side by side: packed instructions.
 */
struct Sums {
    Matrix6 squares = Matrix6::Zero();
    Vector6 gradients = Vector6::Zero();  //!< times the residuals
    double weight = 0;

    void operator+=(const Sums& other) {
        squares += other.squares;
        gradients += other.gradients;
        weight += other.weight;
    }
};
}  // namespace

PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    const Sums sums = sumOver<Sums>(matches, [&](const Correspondence& match, Sums& sum) {
        Vector6 both;
        both << match.point.cross(R.transpose() * match.normal), match.normal;
        const Vector6 weighted = match.weight * both;
        sum.squares.noalias() += weighted * both.transpose();
        sum.gradients += match.residual(R, t) * weighted;
        sum.weight += match.weight;
    });
    const Matrix6& squares = sums.squares;
    const Vector6& gradients = sums.gradients;
    PlaneRotation result;
    result.weight = sums.weight;
    const Eigen::Matrix3d rr = squares.topLeftCorner<3, 3>(), rt = squares.topRightCorner<3, 3>();
    const Eigen::Vector3d gr = gradients.head<3>();
    Eigen::Matrix3d tt = squares.bottomRightCorner<3, 3>();
    Eigen::Vector3d gt = gradients.tail<3>();
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
