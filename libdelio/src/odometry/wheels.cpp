#include "odometry/wheels.h"

#include <cmath>
#include <utility>

namespace delio::odometry {
void Wheels::advance(const ScanClock& scan, const Eigen::Isometry3d& sensorPose, double latest_s) {
    step_.reset();
    hasCarried_ = false;
    time_s_ = scan.time_s;
    if (prior_.isEmpty()) return;
    prior_.advance(scan, sensorPose);
    if (prior_.isPossibleAt(time_s_)) step_ = prior_.between(latest_s, time_s_);
}

Eigen::Isometry3d Wheels::with(const Eigen::Isometry3d& increment) const {
    if (!step_) return increment;
    return isometry(increment.linear(), step_->translation(increment.linear()));
}

Eigen::Isometry3d Wheels::carried(const Eigen::Isometry3d& from,
                                  const Eigen::Isometry3d& predicted) {
    if (!areTrusted()) return predicted;
    hasCarried_ = true;
    return from * with(from.inverse() * predicted);
}

void Wheels::carry(const Eigen::Isometry3d& from, PlaneEstimate& estimate) {
    auto& translation = estimate.translation;
    const Eigen::Matrix3Xd& axes = translation.unobservedAxes;
    if (!step_ || !estimate.valid || axes.cols() == 0) return;
    const Eigen::Matrix3d turned = from.linear().transpose() * estimate.rotation.rotation;
    const Eigen::Vector3d byWheels = from * step_->translation(turned);
    // Wheels that contradict the axes that the scan shows are not mounted as they say.
    constexpr double kMost_m = 0.1, kMostOfWay = 0.1;
    const Eigen::Matrix3d along = axes * axes.transpose(),
                          across = Eigen::Matrix3d::Identity() - along;
    const double moved_m = (byWheels - from.translation()).norm();
    if ((across * (byWheels - translation.translation)).norm() > kMost_m + kMostOfWay * moved_m)
        return;
    translation.translation += along * (byWheels - translation.translation);
    translation.covariance =
        across * translation.covariance * across + std::pow(step_->sigma_m, 2) * along;
    translation.lever = across * translation.lever;
    hasCarried_ = true;
}

void Wheels::learn(bool isObserved, double from_s, double to_s,
                   const Eigen::Isometry3d& increment) {
    if (prior_.isEmpty()) return;
    prior_.count(time_s_, hasCarried_);
    // Two scans in a row have to show every axis.
    if (std::exchange(wasObserved_, isObserved) && isObserved)
        prior_.observe(from_s, to_s, increment);
}
}  // namespace delio::odometry
