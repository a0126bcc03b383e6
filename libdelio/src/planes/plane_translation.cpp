#include "delio/planes/plane_translation.h"

#include <Eigen/Dense>

#include "sum_over.h"

namespace delio::planes {
namespace {
/** Of the information xx, yy, zz and xy, yz, zx: it is symmetric. */
struct Sums {
    Eigen::Vector3d squares = Eigen::Vector3d::Zero(), products = squares, gradient = squares;

    void operator+=(const Sums& other) {
        squares += other.squares;
        products += other.products;
        gradient += other.gradient;
    }
};
}  // namespace

PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    PlaneTranslation result;
    for (const auto& match : matches) {
        const Eigen::Vector3d& n = match.normal;
        const Eigen::Vector3d a = match.point.cross(R.transpose() * n);
        const Eigen::Matrix3d along = n * n.transpose();
        result.information += match.weight * along;
        result.pretended += match.weight * match.tilt * (Eigen::Matrix3d::Identity() - along);
        result.mixed += match.weight * n * a.transpose();
        result.weight += match.weight;
    }
    result.step = stepFromPlanes(matches, pose, prior);
    return result;
}

Eigen::Vector3d stepFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                               const Prior& prior) {
    const Eigen::Matrix3d R = pose.linear();
    const Eigen::Vector3d t = pose.translation();
    const Sums sums = sumOver<Sums>(matches, [&](const Correspondence& match, Sums& sum) {
        const Eigen::Vector3d &n = match.normal, weighted = match.weight * n;
        sum.squares += weighted.cwiseProduct(n);
        sum.products += weighted.cwiseProduct(Eigen::Vector3d(n.y(), n.z(), n.x()));
        sum.gradient += match.residual(R, t) * weighted;
    });
    const Eigen::Vector3d &squares = sums.squares, &products = sums.products;
    const Eigen::Vector3d gradient =
        sums.gradient + prior.translation * (t - prior.pose.translation());
    Eigen::Matrix3d information;
    information << squares[0], products[0], products[2],  //
        products[0], squares[1], products[1],             //
        products[2], products[1], squares[2];
    const Eigen::Matrix3d all = information + prior.translation * Eigen::Matrix3d::Identity();
    return -all.completeOrthogonalDecomposition().solve(gradient);
}
}  // namespace delio::planes
