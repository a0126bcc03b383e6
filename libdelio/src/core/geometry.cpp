#include "delio/core/geometry.h"
#include "portable_math.h"

#include <Eigen/Dense>
#include <cmath>

namespace delio {
namespace {
/** The mean of rotationExp(s w) over s from 0 to 1, which turns a velocity into a way: SO(3)'s left
 *  Jacobian. */
Eigen::Matrix3d meanRotation(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const bool small = angle < 1e-4;
    const double a = small ? 0.5 : (1 - portable::cos(angle)) / (angle * angle);
    const double b = small ? 1.0 / 6 : (angle - portable::sin(angle)) / (angle * angle * angle);
    const Eigen::Matrix3d W = hat(w);
    return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

/** Rotation angle, 0 to pi. */
double angleOf(const Eigen::Quaterniond& q) {
    return 2 * portable::atan2(q.vec().stableNorm(), std::abs(q.w()));
}
}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Eigen::Matrix3d rotationExp(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    if (angle == 0) return Eigen::Matrix3d::Identity();
    const Eigen::Vector3d axis = w / angle;
    const double s = portable::sin(angle), c = portable::cos(angle);
    return c * Eigen::Matrix3d::Identity() + s * hat(axis) + (1 - c) * axis * axis.transpose();
}

Eigen::Vector3d rotationLog(const Eigen::Matrix3d& R) {
    const Eigen::Quaterniond q(R);
    const double sine = q.vec().stableNorm();  // of half the angle
    if (sine == 0) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d axis = q.vec() / sine;
    return (q.w() < 0 ? -1 : 1) * angleOf(q) * axis;
}

double angleOf(const Eigen::Matrix3d& R) { return angleOf(Eigen::Quaterniond(R)); }

Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& w) {
    const double half = w.norm() / 2;
    const double c =
        half < 1e-4 ? 1.0 / 12
                    : (1 - half * portable::cos(half) / portable::sin(half)) / (4 * half * half);
    const Eigen::Matrix3d W = hat(w);
    return Eigen::Matrix3d::Identity() + W / 2 + c * W * W;
}

Eigen::Isometry3d poseExp(const Vector6& twist) {
    const Eigen::Vector3d w = twist.tail<3>();
    return isometry(rotationExp(w), meanRotation(w) * twist.head<3>());
}

Vector6 poseLog(const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d w = rotationLog(pose.linear());
    Vector6 twist;
    twist << meanRotation(w).inverse() * pose.translation(), w;
    return twist;
}

Matrix6 adjointOf(const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d R = pose.linear();
    Matrix6 adjoint;
    adjoint << R, hat(pose.translation()) * R, Eigen::Matrix3d::Zero(), R;
    return adjoint;
}

Eigen::Isometry3d isometry(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = R;
    pose.translation() = t;
    return pose;
}

Eigen::Matrix3d normalised(const Eigen::Matrix3d& R) {
    return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

Eigen::Isometry3d normalised(const Eigen::Isometry3d& pose) {
    return isometry(normalised(Eigen::Matrix3d(pose.linear())), pose.translation());
}

Eigen::Isometry3d fromMrpt(const mrpt::poses::CPose3D& pose) {
    return isometry(pose.getRotationMatrix().asEigen(), {pose.x(), pose.y(), pose.z()});
}

mrpt::poses::CPose3D toMrpt(const Eigen::Isometry3d& pose) {
    return {Eigen::Matrix3d(pose.linear()), Eigen::Vector3d(pose.translation())};
}
}  // namespace delio
