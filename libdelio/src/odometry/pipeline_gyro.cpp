#include <utility>

#include "odometry/pipeline.h"

namespace delio::odometry {
void PlaneOdometry::advanceGyro(const PointCloud& cloud, const Scan& scan) {
    usesGyro_ = false;
    if (gyro_.isEmpty()) return;
    gyro_.advance({time_s_, scan.stamp_s - cloud.stamp_s, endsOf(cloud).second}, scan.sensorPose);
}

/** The scan placed by points, where the gyroscope predicts the rotation and the latest scans the
 *  translation. Nothing where the gyroscope is not trusted or samples are missing. */
std::optional<PlaneOdometry::Attempt> PlaneOdometry::attemptByGyro(const PointCloud& cloud,
                                                                   double duration_s,
                                                                   double since_s, Step& step) {
    if (!gyro_.isTrusted()) return {};
    const auto turned = gyro_.rotation(time_s_ - duration_s, time_s_);
    if (!turned) return {};
    const auto end = extrapolation_;  // is used once
    const Extrapolation extrapolation = predictMotion(duration_s);
    extrapolation_ = end;
    atConstantSpeed_ = pose_ * extrapolation.at(duration_s);
    const Eigen::Isometry3d predicted = isometry(
        normalised(Eigen::Matrix3d(pose_.linear() * *turned)), atConstantSpeed_.translation());
    const auto [first_s, last_s] = endsOf(cloud);
    std::optional<ScanTrajectory> motion(extrapolation.motion());
    if (first_s < last_s)
        motion = gyro_.trajectory(Eigen::Isometry3d::Identity(), extrapolation.motion().velocity,
                                  time_s_, first_s, last_s);
    if (!motion) return {};
    usesGyro_ = true;
    const auto attempt = [&](bool isGuess) {
        return attemptBy(cloud, expectation(predicted, isGuess, since_s, true), *motion, step);
    };
    Attempt best = attempt(isGuessing());
    if (!best.placement.isLikely && !isGuessing()) best = attempt(true);
    best.predicted = best.extrapolated = predicted;
    return best;
}

/** By the gyroscope, where about as many points fit as usual; otherwise the better of that and of
 *  what the scans alone say. */
PlaneOdometry::Attempt PlaneOdometry::attemptWithGyro(const PointCloud& cloud, double duration_s,
                                                      double since_s, bool timeIsKnown,
                                                      Step& step) {
    std::optional<Attempt> byGyro;
    if (timeIsKnown) byGyro = attemptByGyro(cloud, duration_s, since_s, step);
    usesGyro_ = false;
    if (!byGyro || !byGyro->placement.isLikely) {
        Attempt alone = attemptAsPredicted(cloud, duration_s, since_s, timeIsKnown, step);
        if (!byGyro || alone.isBetterThan(*byGyro)) return alone;
    }
    usesGyro_ = true;
    extrapolation_.reset();
    endWindow();
    return *std::move(byGyro);
}

/** From the one pose to the other and on, until the last point of `cloud`, turned as the gyroscope
 *  says. As constantTwist(). */
std::optional<ScanTrajectory> PlaneOdometry::trajectoryByGyro(const KnownEnds& known,
                                                              const PointCloud& cloud) const {
    if (!usesGyro_) return {};
    const Eigen::Vector3d velocity =
        (known.pose.translation() - known.reference.translation()) / known.since_s;
    return gyro_.trajectory(known.pose, velocity, time_s_, -known.since_s, endsOf(cloud).second);
}

/** After a scan that was registered, at pose_, before it becomes the reference. */
void PlaneOdometry::learnFromGyro(const Eigen::Isometry3d& predicted, double since_s) {
    if (!usesGyro_) return;
    gyroKernel_.observe(pose_, predicted);
    const auto turned = gyro_.rotation(time_s_ - since_s, time_s_);
    if (!turned) return;
    const Eigen::Isometry3d even = isometry(*turned, prediction_.predict(since_s).translation());
    gyroUnevenness_.observe(reference_.pose.inverse() * pose_, even);
}
}  // namespace delio::odometry
