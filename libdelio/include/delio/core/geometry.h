#pragma once
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

/** Poses are Eigen::Isometry3d in all of DeLiO: they map the coordinates (metres) of the frame that
 *  they are named after to those of their reference. mrpt::poses::CPose3D appears only at the
 *  border to MRPT. Tangent vectors are [x y z wx wy wz], metres and radians. Formulas: Solà, Deray,
 *  Atchuthan, "A micro Lie theory for state estimation in robotics" (arXiv 1812.01537). */
namespace delio {
/** A tangent vector or a twist: [x y z wx wy wz]. */
using Vector6 = Eigen::Matrix<double, 6, 1>;
/** Covariance or information of one, or its Jacobian. */
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** The matrix of the cross product: hat(v) u = v x u. */
Eigen::Matrix3d hat(const Eigen::Vector3d& v);

/** SO(3): the rotation by |w| radians about w, and back. The logarithm's length is at most pi;
 *  at pi either axis will do. */
Eigen::Matrix3d rotationExp(const Eigen::Vector3d& w);
/** See rotationExp(). */
Eigen::Vector3d rotationLog(const Eigen::Matrix3d& R);

/** Of R in radians, 0 to pi. */
double angleOf(const Eigen::Matrix3d& R);

/** d rotationLog(rotationExp(w) rotationExp(d)) / d d at d = 0: the inverse of SO(3)'s right
 *  Jacobian. For |w| below 2 pi. */
Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& w);

/** SE(3) exponential and logarithm: the pose after moving for a unit of time with constant velocity
 *  (m) and angular rate (rad), both in the moving frame. */
Eigen::Isometry3d poseExp(const Vector6& twist);
/** See poseExp(). */
Vector6 poseLog(const Eigen::Isometry3d& pose);

/** Moves a right tangent [x y z wx wy wz] from the frame that `pose` is named after to its
 *  reference: pose * exp(e) = exp(adjointOf(pose) e) * pose. */
Matrix6 adjointOf(const Eigen::Isometry3d& pose);

/** The pose that maps p to R p + t. */
Eigen::Isometry3d isometry(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

/** Re-orthonormalised rotation: long products of rotations lose orthonormality. */
Eigen::Matrix3d normalised(const Eigen::Matrix3d& R);
/** The same for the rotation of a pose; the translation is unchanged. */
Eigen::Isometry3d normalised(const Eigen::Isometry3d& pose);

/** The border to MRPT. */
Eigen::Isometry3d fromMrpt(const mrpt::poses::CPose3D& pose);
/** See fromMrpt(). */
mrpt::poses::CPose3D toMrpt(const Eigen::Isometry3d& pose);
}  // namespace delio
