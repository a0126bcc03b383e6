#include "delio/scan/deskew.h"

#include <mrpt/poses/Lie/SE.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>

namespace delio::scan {
namespace {
/** exp of the twist over `time_s`, with the closed form of SE(3). */
Eigen::Isometry3f poseAfter(const Motion& motion, double time_s) {
    const Eigen::Vector3d w = time_s * motion.turning, v = time_s * motion.velocity;
    const double angle = w.norm();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (angle < 1e-9) {
        pose.translation() = v;
        return pose.cast<float>();
    }
    const Eigen::Vector3d axis = w / angle;
    pose.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Eigen::Vector3d along = axis * axis.dot(v), across = v - along;
    pose.translation() =
        along + (std::sin(angle) * across + (1 - std::cos(angle)) * axis.cross(v)) / angle;
    return pose.cast<float>();
}
}  // namespace

Motion Motion::of(const mrpt::poses::CPose3D& increment, double duration_s) {
    const Eigen::Matrix<double, 6, 1> twist =
        mrpt::poses::Lie::SE<3>::log(increment).asEigen() / duration_s;
    return {twist.head<3>(), twist.tail<3>()};
}

std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s) {
    std::vector<float> times_s(static_cast<std::size_t>(points.cols()));
    const auto perRadian = static_cast<float>(-sweep_s / (2 * M_PI));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        times_s[static_cast<std::size_t>(i)] =
            perRadian * std::atan2(points(1, i), points(0, i));
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
