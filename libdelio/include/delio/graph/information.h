#pragma once
#include <Eigen/Geometry>

#include "delio/graph/residual.h"

namespace delio::graph {
/** What the rows and columns of an edge's information matrix stand for. */
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
