#include "delio/prediction.h"

#include <Eigen/Dense>
#include <cmath>

namespace delio {
using mrpt::poses::CPose3D;

namespace {
/** [v w]: the constant speed and rate of turn (in the moving frame) that lead to a pose in unit
 *  time. MRPT's Lie::SE<3> leaves the translation as it is, so that its logarithm is not that of a
 *  constant motion: half of it is not half the way. */
using Twist = Eigen::Matrix<double, 6, 1>;

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

Twist logOf(const CPose3D& pose) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose.getRotationMatrix().asEigen()));
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    Twist twist;
    twist << meanRotation(w).inverse() * Eigen::Vector3d(pose.x(), pose.y(), pose.z()), w;
    return twist;
}

CPose3D expOf(const Twist& twist) {
    const Eigen::Vector3d w = twist.tail<3>();
    const double angle = w.norm();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (angle > 0) R = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    return {R, Eigen::Vector3d(meanRotation(w) * twist.head<3>())};
}
}  // namespace

std::vector<OptionField> PredictionOptions::fields() {
    return {{"frames", &frames, "N: increments that the prediction is made of", 1, 100}};
}

CPose3D LinearPrediction::predict(double duration_s) const {
    Twist mean = Twist::Zero();
    const auto n = static_cast<double>(latestFirst_.size());
    for (std::size_t j = 0; j < latestFirst_.size(); ++j)
        mean += duration_s / latestFirst_[j].duration_s * 2 * (n - static_cast<double>(j)) /
                (n * (n + 1)) * logOf(latestFirst_[j].increment);
    return expOf(mean);
}

void LinearPrediction::observe(const CPose3D& increment, double duration_s) {
    latestFirst_.push_front({increment, duration_s});
    if (latestFirst_.size() > frames_) latestFirst_.pop_back();
}
}  // namespace delio
