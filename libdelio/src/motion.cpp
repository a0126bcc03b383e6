#include "delio/motion.h"

#include <Eigen/Dense>
#include <cmath>

namespace delio {
namespace {
/** The mean of exp(s w) over s from 0 to 1: what turns v into the translation. */
Eigen::Matrix3d meanRotation(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const bool small = angle < 1e-4;
    const double a = small ? 0.5 : (1 - std::cos(angle)) / (angle * angle);
    const double b = small ? 1.0 / 6 : (angle - std::sin(angle)) / (angle * angle * angle);
    Eigen::Matrix3d W;
    W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}
}  // namespace

Motion Motion::of(const mrpt::poses::CPose3D& increment, double duration_s) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(increment.getRotationMatrix().asEigen()));
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    const Eigen::Vector3d t(increment.x(), increment.y(), increment.z());
    return {meanRotation(w).inverse() * t / duration_s, w / duration_s};
}

Eigen::Isometry3d Motion::after(double time_s) const {
    const Eigen::Vector3d w = time_s * turning;
    const double angle = w.norm();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    pose.translation() = meanRotation(w) * (time_s * velocity);
    return pose;
}
}  // namespace delio
