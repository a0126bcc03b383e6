#include <cmath>
#include <utility>

#include "odometry/pipeline.h"

namespace delio::odometry {
void PlaneOdometry::advanceWheels(const PointCloud& cloud, const Scan& scan) {
    wheelStep_.reset();
    isCarried_ = false;
    if (wheels_.isEmpty()) return;
    wheels_.advance({time_s_, scan.stamp_s - cloud.stamp_s, endsOf(cloud).second}, scan.sensorPose);
    if (wheels_.isPossibleAt(time_s_)) wheelStep_ = wheels_.between(stamped_.time_s, time_s_);
}

/** The same increment since the latest scan, with the translation of the wheels where these say
 *  it. */
Eigen::Isometry3d PlaneOdometry::withWheels(const Eigen::Isometry3d& increment) const {
    if (!wheelStep_) return increment;
    return isometry(increment.linear(), wheelStep_->translation(increment.linear()));
}

/** From where the wheels lead, if clearly fewer points fit than usual without them. */
PlaneOdometry::Attempt PlaneOdometry::attemptByWheels(const PointCloud& cloud, double duration_s,
                                                      Attempt alone, Step& step) {
    if (!wheelStep_ || alone.placement.isLikely || !wheels_.isTrustedAt(time_s_)) return alone;
    const Eigen::Isometry3d increment = withWheels(prediction_.predict(duration_s));
    const double since_s = time_s_ - reference_.time_s;
    Attempt byWheels = attemptBy(cloud, expectation(pose_ * increment, true, since_s, true),
                                 Twist::of(increment, duration_s), step);
    if (!byWheels.isBetterThan(alone)) return alone;
    usesGyro_ = false;
    endWindow();
    return byWheels;
}

/** Where a scan is that is not registered. */
Eigen::Isometry3d PlaneOdometry::predictedByWheels(const Eigen::Isometry3d& predicted) {
    if (!wheelStep_ || !wheels_.isTrustedAt(time_s_)) return predicted;
    isCarried_ = true;
    return pose_ * withWheels(pose_.inverse() * predicted);
}

/** Along the axes that neither planes nor points show, the wheels say where the sensor is. */
void PlaneOdometry::carryByWheels(PlaneEstimate& estimate) {
    auto& translation = estimate.translation;
    const Eigen::Matrix3Xd& axes = translation.unobservedAxes;
    if (!wheelStep_ || !estimate.valid || axes.cols() == 0) return;
    const Eigen::Matrix3d turned = pose_.linear().transpose() * estimate.rotation.rotation;
    const Eigen::Vector3d byWheels = pose_ * wheelStep_->translation(turned);
    // Wheels that contradict the axes that the scan shows are not mounted as they say.
    constexpr double kMost_m = 0.1, kMostOfWay = 0.1;
    const Eigen::Matrix3d along = axes * axes.transpose(),
                          across = Eigen::Matrix3d::Identity() - along;
    const double moved_m = (byWheels - pose_.translation()).norm();
    if ((across * (byWheels - translation.translation)).norm() > kMost_m + kMostOfWay * moved_m)
        return;
    translation.translation += along * (byWheels - translation.translation);
    translation.covariance =
        across * translation.covariance * across + std::pow(wheelStep_->sigma_m, 2) * along;
    translation.lever = across * translation.lever;
    isCarried_ = true;
}

/** From two scans in a row that show every axis. */
void PlaneOdometry::learnFromWheels(Step& step) {
    step.carried = isCarried_;
    if (wheels_.isEmpty()) return;
    wheels_.count(time_s_, isCarried_);
    const bool isObserved = std::holds_alternative<Tracking>(state_) && !step.predicted &&
                            !step.interrupted && step.corrected.empty() &&
                            step.quality.unobservedTranslation.cols() == 0;
    const bool areBoth = std::exchange(wasObserved_, isObserved) && isObserved;
    if (!areBoth || past_.size() < 2) return;
    const auto& before = past_[past_.size() - 2];
    wheels_.observe(before.stamp_s, stamped_.time_s + stamped_.stamp_s, step.increment.pose);
}
}  // namespace delio::odometry
