#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <utility>

#include "odometry/pipeline.h"
#include "odometry/reporting.h"

namespace delio::odometry {
namespace {
/** Over a long time a vehicle goes on turning, but not tilting. */
Eigen::Isometry3d withoutTilt(const Eigen::Isometry3d& increment, const Eigen::Matrix3f& upright) {
    const Eigen::Vector3d up = upright.row(2).transpose().cast<double>();
    Vector6 moved = poseLog(increment);
    moved.tail<3>() = up.dot(moved.tail<3>()) * up;
    return poseExp(moved);
}
}  // namespace

/** The scan placed by points. */
PlaneOdometry::Attempt PlaneOdometry::attemptToTrack(const PointCloud& cloud,
                                                     const Interval& interval, Step& step) {
    // After scans that were not registered, the motion since the last registered one counts.
    const double since_s = time_s_ - reference_.time_s;
    if (step.interrupted && prediction_.hasMotion())
        return attemptAfterPause(cloud, interval, since_s, step);
    Attempt attempt =
        attemptWithGyro(cloud, interval.duration_s, since_s, !reference_.isBeforePause, step);
    attempt = attemptByWheels(cloud, interval.duration_s, std::move(attempt), step);
    if (isImplausible(attempt.placement.estimate)) attempt.placement.estimate.valid = false;
    return attempt;
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

/** The scan placed by points, `duration_s` after the one before. */
PlaneOdometry::Attempt PlaneOdometry::attemptAsPredicted(const PointCloud& cloud, double duration_s,
                                                         double since_s, bool timeIsKnown,
                                                         Step& step) {
    const Extrapolation extrapolation = predictMotion(duration_s);
    const Eigen::Isometry3d extrapolated = pose_ * extrapolation.at(duration_s);
    const auto attempt = [&](bool isGuess) {
        Expectation expected = expectation(extrapolated, isGuess, since_s, timeIsKnown);
        Attempt best = attemptBy(cloud, expected, extrapolation.motion(), step);
        if (isGuess || !expected.isPlacedByStanding || best.placement.isLikely) return best;
        // A sensor that tilts further than expected takes the ground for what stands on it.
        expected.isPlacedByStanding = false;
        Attempt byAll = attemptBy(cloud, expected, extrapolation.motion(), step);
        return byAll.isBetterThan(best) ? byAll : best;
    };
    const bool isTogether = timeIsKnown && !cloud.times_s.empty() && !isUrgent_;
    if (!isTogether) endWindow();
    const bool wasTogether = !window_.isEmpty();
    Attempt best;
    if (!wasTogether) {
        best = attempt(isGuessing());
        if (best.placement.isLikely && !isShaken() && !isSecondScan()) return best;
        if (!best.placement.isLikely && !isGuessing()) best = attempt(true);
    }
    const bool isExtended = isTogether && extendWindow(cloud, since_s, best.placement, step);
    if (!isExtended) return wasTogether ? attempt(true) : best;
    Attempt together = attemptInWindow(cloud, since_s, step);
    if (wasTogether && !together.placement.isLikely)
        together = attemptAgain(cloud, since_s, std::move(together), step);
    together.extrapolated = pose_ * extrapolation.at(duration_s);
    if (wasTogether && !together.placement.isLikely) best = attempt(true);
    if (together.placement.estimate.valid && !best.isBetterThan(together)) return together;
    endWindow();
    return best;
}

/** The scan placed by points, after a pause in which the motion went on as before, or in which the
 *  sensor stood: where more points fit. */
PlaneOdometry::Attempt PlaneOdometry::attemptAfterPause(const PointCloud& cloud,
                                                        const Interval& interval, double since_s,
                                                        Step& step) {
    const LinearPrediction before = prediction_;
    Attempt wentOn = attemptAsPredicted(cloud, interval.elapsed_s, interval.elapsed_s, true, step);
    prediction_.forget();
    Attempt stood = attemptAsPredicted(cloud, interval.duration_s, since_s, false, step);
    prediction_ = before;
    for (Attempt* attempt : {&wentOn, &stood})
        if (isImplausible(attempt->placement.estimate)) attempt->placement.estimate.valid = false;
    if (!stood.isBetterThan(wentOn)) return wentOn;
    prediction_.forget();
    return stood;
}

/** From where the wheels lead, if clearly fewer points fit than usual without them. */
PlaneOdometry::Attempt PlaneOdometry::attemptByWheels(const PointCloud& cloud, double duration_s,
                                                      Attempt alone, Step& step) {
    if (alone.placement.isLikely || !wheels_.areTrusted()) return alone;
    const Eigen::Isometry3d increment = wheels_.with(prediction_.predict(duration_s));
    const double since_s = time_s_ - reference_.time_s;
    Attempt byWheels = attemptBy(cloud, expectation(pose_ * increment, true, since_s, true),
                                 Twist::of(increment, duration_s), step);
    if (!byWheels.isBetterThan(alone)) return alone;
    usesGyro_ = false;
    endWindow();
    return byWheels;
}

/** The scan placed by points near where it is expected, de-skewed by a motion. */
PlaneOdometry::Attempt PlaneOdometry::attemptBy(const PointCloud& cloud,
                                                const Expectation& expected,
                                                const ScanTrajectory& motion, Step& step) {
    Attempt attempt;
    attempt.predicted = attempt.extrapolated = expected.pose;
    attempt.motion = motion;
    {
        const StageTimer timer(step, "undistort");
        attempt.view = undistorted(cloud, attempt.motion);
    }
    std::optional<RangeImage> freeSpace;
    {
        const StageTimer timer(step, "thinning");
        freeSpace = thin(attempt.view, expected.isPlacedByStanding);
    }
    attempt.sight =
        registerByPoints(attempt.view, expected, std::move(freeSpace), attempt.placement, step);
    auto& estimate = attempt.placement.estimate;
    estimate = map_.levelled(attempt.view, estimate);
    attempt.placement.isLikely =
        estimate.valid && estimate.inlierRatio >= expected.likelyInlierRatio();
    return attempt;
}

/** True where the scan lies nearer to the latest registered one than any braking allows, and
 * clearly fewer points fit than there. On a road that looks the same everywhere, scans fit at a
 * wrong place like that. A scan that fits about as well as before is accepted: the clock may have
 * been set. */
bool PlaneOdometry::isImplausible(const PointEstimate& placed) const {
    constexpr double kLong_s = 0.5, kAsBefore = 0.9;
    const bool isNewMap = std::holds_alternative<FirstScan>(state_);
    if (unregistered_s_ <= kLong_s || isNewMap || !prediction_.hasMotion()) return false;
    const double speed_mps = prediction_.predict(1).translation().norm(),
                 acceleration = options().spacing.braking,
                 braking_s = std::min(speed_mps / acceleration, unregistered_s_),
                 least_m = (speed_mps - acceleration / 2 * braking_s) * braking_s;
    const Eigen::Vector3d moved = placed.pose.translation() - reference_.pose.translation();
    return moved.norm() < least_m && placed.inlierRatio < kAsBefore * inlierRatios_.latest;
}

Motion PlaneOdometry::motion() const {
    constexpr double kSlow_mps = 0.5;
    if (!prediction_.hasMotion()) return Motion::kUnknown;
    const bool isSlow = prediction_.predict(1).translation().norm() < kSlow_mps;
    return isSlow ? Motion::kSlow : Motion::kFast;
}

/** The motion after the latest scan. Its end twist, where that is known, is used once. */
Extrapolation PlaneOdometry::predictMotion(double duration_s) {
    constexpr double kLong_s = 0.5;
    Eigen::Isometry3d increment = prediction_.predict(duration_s);
    if (duration_s > kLong_s) increment = withoutTilt(increment, upright_);
    if (std::holds_alternative<Degenerate>(state_)) increment = wheels_.with(increment);
    Extrapolation extrapolation(increment, duration_s);
    const bool isKnown = !isLost(state_) && !std::holds_alternative<Degenerate>(state_);
    if (extrapolation_ && isKnown) extrapolation = *extrapolation_;
    // Only a hand turns so fast, and back again.
    const bool isSwing = extrapolation.motion().turning.norm() > options().spacing.first_turn_radps;
    if (isSwing && missesOf(state_) > 0)
        extrapolation = Extrapolation(
            isometry(Eigen::Matrix3d::Identity(), increment.translation()), duration_s);
    extrapolation_.reset();
    return extrapolation;
}

/** What is known of the next scan's pose, `since_s` after the latest registered scan. */
Expectation PlaneOdometry::expectation(const Eigen::Isometry3d& predicted, bool isGuess,
                                       double since_s, bool timeIsKnown) const {
    const auto& spacing = options().spacing;
    const auto& registration = options().registration;
    // A longer way has to be found by surfaces.
    constexpr double kLongest_s = 0.5;
    const double unknown_s = std::max(since_s, unregistered_s_);
    const double acceleration =
        unknown_s <= kLongest_s ? spacing.acceleration : spacing.pause_acceleration;
    const double driven_m = spacing.first_speed * std::min(since_s, kLongest_s),
                 gained_m = acceleration / 2 * unknown_s * unknown_s;
    Expectation expected{predicted, reference_, upright_};
    expected.motionIsKnown = prediction_.hasMotion();
    expected.isGuess = isGuess;
    expected.isUrgent = isUrgent_;
    expected.start.metres = expected.motionIsKnown ? std::min(gained_m, driven_m) : driven_m;
    expected.start.turn_rad = std::min(spacing.first_turn_radps * since_s, spacing.most_turn_rad);
    expected.reach_m =
        timeIsKnown ? std::min(plane_tuning::kSearchSpeed_mps * since_s, registration.search_radius)
                    : registration.search_radius;
    expected.kernel_m = kernel_m();
    expected.isShaken = isShaken();
    expected.isPlacedByStanding = isPlacedByStanding(isGuess);
    expected.usualInlierRatio = inlierRatios_.usual;
    return expected;
}

/** Thins the scan, while the one before it enters the map. Returns the free space that it shows,
 *  where this is needed. */
std::optional<RangeImage> PlaneOdometry::thin(ScanView& view, bool byStanding) {
    const auto& spacings = options().spacing;
    std::optional<RangeImage> freeSpace;
    tbb::parallel_invoke(
        [&] { insertWaiting(); },
        [&] {
            thinForMap(view, spacings.map_spacing);
            tbb::parallel_invoke(
                [&] { thinForPoints(view, upright_, spacings.point_spacing, byStanding); },
                [&] { numberForPlanes(view, spacings.scan_spacing); });
        },
        [&] {
            if (options().dynamics.enabled && !isLost(state_))
                freeSpace = dynamics_.freeSpaceOf(view.points);
        });
    return freeSpace;
}

/** Meanwhile segments of the scan are found, where its free space is known. */
std::optional<DynamicObjects::Sight> PlaneOdometry::registerByPoints(
    const ScanView& view, const Expectation& expected, std::optional<RangeImage> freeSpace,
    Placement& placement, Step& step) const {
    const StageTimer timer(step, "points");
    std::optional<DynamicObjects::Sight> sight;
    tbb::parallel_invoke([&] { placement = placeScan(map_, view, expected, options()); },
                         [&] {
                             if (freeSpace)
                                 sight = dynamics_.see(view.fine, *std::move(freeSpace), upright_);
                         });
    return sight;
}
}  // namespace delio::odometry
