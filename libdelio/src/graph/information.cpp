#include "delio/graph/information.h"

#include <Eigen/LU>
#include <cmath>

namespace delio::graph {
namespace {
/** d (tangent error) / d (the other's numbers). */
Matrix6 tangentBy(InformationOf terms, const mrpt::poses::CPose3D& pose) {
    Matrix6 K = Matrix6::Identity();
    if (terms == InformationOf::quaternion) K.bottomRightCorner<3, 3>() *= 2;
    if (terms == InformationOf::yawPitchRoll) {
        const double sp = std::sin(pose.pitch()), cp = std::cos(pose.pitch());
        const double sr = std::sin(pose.roll()), cr = std::cos(pose.roll());
        K.topLeftCorner<3, 3>() = pose.getRotationMatrix().asEigen().transpose();
        K.bottomRightCorner<3, 3>() << -sp, 0, 1, cp * sr, cr, 0, cp * cr, -sr, 0;
    }
    return K;
}
}  // namespace

Matrix6 convertInformation(const Matrix6& information, const mrpt::poses::CPose3D& pose,
                           InformationOf from, InformationOf to) {
    // e = K1 a = K2 b, so that a = K1^-1 K2 b.
    const Matrix6 K = tangentBy(from, pose).partialPivLu().solve(tangentBy(to, pose));
    const Matrix6 converted = K.transpose() * information * K;
    return (converted + converted.transpose()) / 2;
}
}  // namespace delio::graph
