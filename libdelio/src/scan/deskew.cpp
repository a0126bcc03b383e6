#include "delio/scan/deskew.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <cmath>

namespace delio::scan {
namespace {
Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& w) {
    Eigen::Matrix3d matrix;
    matrix << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return matrix;
}

/** What the velocity is multiplied with where the rotation vector w is turned by meanwhile: the
 *  matrix V of SE(3)'s exponential. (MRPT's Lie::SE<3> takes the identity for it.) */
Eigen::Matrix3d bend(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const Eigen::Matrix3d W = crossMatrix(w);
    if (angle < 1e-6) return Eigen::Matrix3d::Identity() + W / 2;
    return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / (angle * angle) * W +
           (angle - std::sin(angle)) / (angle * angle * angle) * W * W;
}

Eigen::Isometry3f poseAfter(const Motion& motion, double time_s) {
    const Eigen::Vector3d w = time_s * motion.turning;
    const double angle = w.norm();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    pose.translation() = bend(w) * (time_s * motion.velocity);
    return pose.cast<float>();
}
}  // namespace

Motion Motion::of(const mrpt::poses::CPose3D& increment, double duration_s) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(increment.getRotationMatrix().asEigen()));
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    const Eigen::Vector3d t(increment.x(), increment.y(), increment.z());
    return {bend(w).inverse() * t / duration_s, w / duration_s};
}

std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s) {
    std::vector<float> times_s(static_cast<std::size_t>(points.cols()));
    const auto perRadian = static_cast<float>(-sweep_s / (2 * M_PI));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        times_s[static_cast<std::size_t>(i)] = perRadian * std::atan2(points(1, i), points(0, i));
    return times_s;
}

Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const Motion& motion) {
    Eigen::Matrix3Xf result(3, points.cols());
    tbb::parallel_for(Eigen::Index{0}, points.cols(), [&](Eigen::Index i) {
        const double time_s = double{times_s[static_cast<std::size_t>(i)]};
        result.col(i) = poseAfter(motion, time_s) * points.col(i);
    });
    return result;
}
}  // namespace delio::scan
