#pragma once
#include "delio/core/geometry.h"

namespace delio::graph {
/** How far two poses are from what an edge between them measured. With Z the measured increment,
 *  E = Z^-1 T_from^-1 T_to and error = [translation of E, log of the rotation of E]: the error of
 *  delio::Increment, in its order [x y z wx wy wz], in metres and radians. */
struct Residual {
    Vector6 error;  //!< [x y z wx wy wz], metres and radians
    Matrix6 dFrom;  //!< d error / d e for T_from * (exp(w), t), e = [t w]
    Matrix6 dTo;    //!< the same for T_to * (exp(w), t)
};

/** Residual of the edge `increment` between nodes at `from` and `to`. */
Residual residualOf(const Eigen::Isometry3d& increment, const Eigen::Isometry3d& from,
                    const Eigen::Isometry3d& to);

/** Meaning of the rows and columns of an information matrix. */
enum class InformationOf {
    /** delio::Increment's error [x y z wx wy wz], pose_true = pose * (exp(w), t): metres and
     *  radians, axes of the later frame. */
    tangent,
    /** g2o's EDGE_SE3:QUAT: [x y z qx qy qz], the vector part of the error's quaternion, which is
     *  half the angle: metres and half radians, axes of the later frame. */
    quaternion,
    /** MRPT's CPose3DPDFGaussianInf: the numbers of the pose itself, [x y z yaw pitch roll]: metres
     *  and radians, x y z along the axes of the earlier frame. */
    yawPitchRoll
};

/** The same information about the measured `pose` in other terms; to and from half angles exact to
 *  the bit. Yaw and roll are one at a pitch of +-90 deg, from where there is no way back. */
Matrix6 convertInformation(const Matrix6& information, const Eigen::Isometry3d& pose,
                           InformationOf from, InformationOf to);
}  // namespace delio::graph
