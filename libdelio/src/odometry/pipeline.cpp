#include "odometry/pipeline.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <utility>

#include "odometry/preprocess.h"
#include "odometry/reporting.h"
#include "odometry/spin_axis.h"

namespace delio::odometry {
namespace {
Eigen::Isometry3d inverseOf(const Eigen::Matrix3f& rotation) {
    return Eigen::Isometry3d(rotation.transpose().cast<double>());
}

/** Over a long time a vehicle goes on turning, but not tilting. */
Eigen::Isometry3d withoutTilt(const Eigen::Isometry3d& increment, const Eigen::Matrix3f& upright) {
    const Eigen::Vector3d up = upright.row(2).transpose().cast<double>();
    Vector6 moved = poseLog(increment);
    moved.tail<3>() = up.dot(moved.tail<3>()) * up;
    return poseExp(moved);
}

/** True for a scan that was registered along and about every axis and moved slower than the noise
 *  of a registration over one turn. */
bool isStanding(const Step& step, double duration_s) {
    constexpr double kSlow_mps = 0.1, kSlow_radps = 2 * M_PI / 180;
    const Quality& quality = step.quality;
    if (step.predicted || quality.unobservedTranslation.cols() > 0 ||
        quality.unobservedRotation.cols() > 0)
        return false;
    const Eigen::Isometry3d& moved = step.increment.pose;
    return moved.translation().norm() < kSlow_mps * duration_s &&
           angleOf(moved.linear()) < kSlow_radps * duration_s;
}

/** The figures of both registrations. */
std::vector<Named> detailsOf(const PlaneEstimate& estimate, const PointEstimate& placed) {
    const bool byPlanes = estimate.valid && estimate.rotation.observability[2] > 0;
    const auto& rotation = estimate.rotation;
    return {{"inlier_ratio", placed.inlierRatio},
            {"kernel_m", placed.kernel_m},
            {"iterations", static_cast<double>(placed.iterations)},
            {"converged", static_cast<double>(placed.converged)},
            {"plane_inlier_ratio", byPlanes ? estimate.inlierRatio : 0},
            {"plane_iterations", byPlanes ? static_cast<double>(rotation.iterations) : 0},
            {"plane_converged", byPlanes ? static_cast<double>(rotation.converged) : 0}};
}
}  // namespace

PlaneOdometry::PlaneOdometry(const PlaneOdometryOptions& options)
    : given_(options),
      options_(atScale(options, 1)),
      arrivals_(needsTimes(options.scan)),
      map_(LocalMapTuning(), options.map, options.registration, options.pointMap, options.points),
      dynamics_(options.dynamics),
      prediction_(options.prediction) {}

Step PlaneOdometry::process(const Scan& scan) {
    requireConsistent(scan);
    Step step;
    step.times_ms = noTimes();
    seenScale_ = given_.tracker.scale > 0 ? given_.tracker.scale : scaleOf(scan);
    const bool isEmpty = std::holds_alternative<Empty>(state_);
    if (isEmpty) takeScale(seenScale_);
    PointCloud cloud;
    {
        const StageTimer timer(step, "preprocess");
        cloud = own_.without(preprocess(scan, options_.scan));
        countFromMiddle(cloud);
        if (isEmpty) upright_ = uprightOf(scan.sensorPose, cloud.points);
    }
    const Arrival arrival = arrivals_.take(scan, scan.stamp_s - cloud.stamp_s);
    time_s_ = arrivals_.sinceStart_s();
    const Interval& interval = arrival.interval;
    unregistered_s_ += interval.elapsed_s;
    advancePriors(cloud, scan);
    step.notFinite = cloud.notFinite;
    step.deskewed = !cloud.times_s.empty();
    step.interrupted = !isEmpty && interval.kind == IntervalKind::kUnknown;
    if (step.interrupted) interrupt(interval.elapsed_s);
    if (!isEmpty) step.reason = reasonToSkip(arrival, prediction_);

    const bool motionWasKnown = !isLost(state_);
    if (isEmpty)
        begin(cloud, step);
    else if (!step.reason.empty())
        skip(cloud, interval, step);
    else
        track(cloud, attemptToTrack(cloud, interval, step), step);
    retraceStart(cloud, step);
    carryToStamp(cloud.stamp_s, !motionWasKnown && !step.predicted && !step.interrupted, step);
    settleWindow(step);
    correctPast(step);
    learnFromWheels(step);

    step.standing = isStanding(step, interval.duration_s);
    step.lost = isLostAfter(step);
    step.track = track_;
    if (!step.predicted) unregistered_s_ = 0;
    if (!isLost(state_) && isOtherScale()) {
        takeScale(seenScale_);
        beginMap(cloud, !std::holds_alternative<Degenerate>(state_));
    }
    step.details.emplace_back("scale", scale_);
    gyro_.count(usesGyro_);
    step.used.indices = std::move(cloud.indices);
    keep(std::move(cloud), step);
    return step;
}

/** After a pause, or a clock that was set. */
void PlaneOdometry::interrupt(double elapsed_s) {
    constexpr double kLongest_s = 3.5;  // longer, the motion is not extrapolated
    if (elapsed_s > kLongest_s) prediction_.forget();
    reference_.isBeforePause = true;
    state_ = lostFrom(std::move(state_), missesOf(state_));
}

/** A degenerate scan is not lost while the motion is known. */
bool PlaneOdometry::isLostAfter(const Step& step) const {
    constexpr unsigned kPatience = 3;
    if (const auto* degenerate = std::get_if<Degenerate>(&state_))
        return !isCarried_ && !prediction_.hasMotion() && degenerate->scans >= kPatience;
    return step.predicted && missesOf(state_) > 0;
}

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

/** The method: a scan against the map of earlier scans. */
void PlaneOdometry::track(const PointCloud& cloud, Attempt attempt, Step& step) {
    const double since_s = time_s_ - reference_.time_s;
    auto& [predicted, extrapolated, motion, view, voxels, sight, placement] = attempt;
    motion_ = motion;
    const PointEstimate& placed = placement.estimate;
    step.searched = placement.searched;
    step.interrupted = step.interrupted || isBeyondReach(placed, predicted, since_s);

    const bool hasSight = sight && placed.valid;
    if (hasSight) {
        const StageTimer timer(step, "dynamic");
        removeDynamicObjects(voxels, std::move(*sight), placed.pose, view);
    }
    const auto estimate = registerByPlanes(cloud, placed, predicted, since_s, view, step);

    pose_ = estimate.valid ? estimate.pose() : predictedByWheels(predicted);
    {
        const StageTimer timer(step, "map_update");
        if (estimate.valid)
            update(estimate, placed, extrapolated, since_s, hasSight, view, step);
        else
            miss(cloud);
        if (left_ && estimate.valid) rejoin(view);
        if (hasDrifted(estimate, placed.inlierRatio)) beginAnew(cloud);
    }
    if (!estimate.valid)
        step.reason = cloud.points.cols() == 0 ? "no points" : "not found in the map";
    step.details = detailsOf(estimate, placed);
    report(estimate, view, step);
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

/** True where the scan lies nearer to the latest registered one than any braking allows, and
 * clearly fewer points fit than there. On a road that looks the same everywhere, scans fit at a
 * wrong place like that. A scan that fits about as well as before is accepted: the clock may have
 * been set. */
bool PlaneOdometry::isImplausible(const PointEstimate& placed) const {
    constexpr double kLong_s = 0.5, kAsBefore = 0.9;
    const bool isNewMap = std::holds_alternative<FirstScan>(state_);
    if (unregistered_s_ <= kLong_s || isNewMap || !prediction_.hasMotion()) return false;
    const double speed_mps = prediction_.predict(1).translation().norm(),
                 acceleration = options_.spacing.braking,
                 braking_s = std::min(speed_mps / acceleration, unregistered_s_),
                 least_m = (speed_mps - acceleration / 2 * braking_s) * braking_s;
    const Eigen::Vector3d moved = placed.pose.translation() - reference_.pose.translation();
    return moved.norm() < least_m && placed.inlierRatio < kAsBefore * latestInlierRatio_;
}

/** The scan placed by points, `duration_s` after the one before. */
PlaneOdometry::Attempt PlaneOdometry::attemptAsPredicted(const PointCloud& cloud, double duration_s,
                                                         double since_s, bool timeIsKnown,
                                                         Step& step) {
    const Extrapolation extrapolation = predictMotion(duration_s);
    const Eigen::Isometry3d extrapolated = pose_ * extrapolation.at(duration_s);
    const auto attempt = [&](bool isGuess) {
        return attemptBy(cloud, expectation(extrapolated, isGuess, since_s, timeIsKnown),
                         extrapolation.motion(), step);
    };
    const bool isTogether = timeIsKnown && !cloud.times_s.empty();
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
    {
        const StageTimer timer(step, "thinning");
        attempt.voxels = thin(attempt.view, expected.isPlacedByStanding);
    }
    attempt.placement = registerByPoints(attempt.view, expected, attempt.sight, step);
    auto& estimate = attempt.placement.estimate;
    estimate = map_.levelled(attempt.view, estimate);
    attempt.placement.isLikely =
        estimate.valid && estimate.inlierRatio >= expected.likelyInlierRatio();
    return attempt;
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
    if (std::holds_alternative<Degenerate>(state_)) increment = withWheels(increment);
    Extrapolation extrapolation(increment, duration_s);
    const bool isKnown = !isLost(state_) && !std::holds_alternative<Degenerate>(state_);
    if (extrapolation_ && isKnown) extrapolation = *extrapolation_;
    // Only a hand turns so fast, and back again.
    const bool isSwing = extrapolation.motion().turning.norm() > options_.spacing.first_turn_radps;
    if (isSwing && missesOf(state_) > 0)
        extrapolation = Extrapolation(
            isometry(Eigen::Matrix3d::Identity(), increment.translation()), duration_s);
    extrapolation_.reset();
    return extrapolation;
}

/** Thins the scan, while the one before it enters the map; says which points became which. */
VoxelNumbers PlaneOdometry::thin(ScanView& view, bool byStanding) {
    const auto& spacings = options_.spacing;
    VoxelNumbers voxels;
    tbb::parallel_invoke([&] { insertWaiting(); },
                         [&] {
                             voxels = numberVoxels(view.points, spacings.map_spacing);
                             view.fine = centroidsOf(view.points, voxels);
                             thinForPoints(view, upright_, spacings.point_spacing, byStanding);
                         });
    return voxels;
}

/** Meanwhile segments and free space of the scan are found, where these are needed (`sight`). */
Placement PlaneOdometry::registerByPoints(const ScanView& view, const Expectation& expected,
                                          std::optional<DynamicObjects::Sight>& sight,
                                          Step& step) const {
    const StageTimer timer(step, "points");
    Placement placement;
    tbb::parallel_invoke([&] { placement = placeScan(map_, view, expected, options_); },
                         [&] {
                             if (options_.dynamics.enabled && !isLost(state_))
                                 sight = dynamics_.see(view.fine, view.points, upright_);
                         });
    return placement;
}

/** From the thinned scan, whose pose is known by points. */
void PlaneOdometry::removeDynamicObjects(const VoxelNumbers& voxels, DynamicObjects::Sight sight,
                                         const Eigen::Isometry3d& pose, ScanView& view) {
    const auto dynamic = dynamics_.detect(std::move(sight), pose * inverseOf(upright_), time_s_);
    map_.erase(dynamics_.unmasked());
    for (std::size_t i = 0; i < view.dynamic.size(); ++i)
        view.dynamic[i] = dynamic[voxels.ofPoint[i]];
    view.fine = unmarked(view.fine, dynamic);
}

PlaneEstimate PlaneOdometry::registerByPlanes(const PointCloud& cloud, const PointEstimate& placed,
                                              const Eigen::Isometry3d& predicted, double since_s,
                                              ScanView& view, Step& step) {
    const StageTimer timer(step, "planes");
    if (!placed.valid) return predictedEstimate(predicted);
    view.thinned = voxelCentroids(view.fine, options_.spacing.scan_spacing).cast<double>();
    auto found = map_.registerPlanes(view, placed, predicted, motion());
    carryByWheels(found);
    if (step.deskewed && !step.interrupted && window_.isEmpty()) {
        deskewAgain(cloud, since_s, placed.inlierRatio, view, found);
        carryByWheels(found);
    }
    return found;
}

/** No vehicle moves so: scans are missing before this one, whatever their stamps say. */
bool PlaneOdometry::isBeyondReach(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                                  double since_s) const {
    const double most_m =
        options_.points.first_kernel + options_.spacing.acceleration / 2 * since_s * since_s;
    return placed.valid && prediction_.hasMotion() &&
           (placed.pose.translation() - predicted.translation()).norm() > most_m;
}

/** After a scan that was registered, at pose_. */
void PlaneOdometry::update(const PlaneEstimate& estimate, const PointEstimate& placed,
                           const Eigen::Isometry3d& predicted, double since_s, bool hasSight,
                           ScanView& view, const Step& step) {
    const bool isDegenerate = estimate.translation.unobservedAxes.cols() > 0;
    const auto* latest = std::get_if<Degenerate>(&state_);
    const bool isTimeKnown = !step.interrupted && !reference_.isBeforePause;
    if (step.interrupted || (!isTimeKnown && !isDegenerate))
        state_ = Lost{};  // the speed is not known
    else if (isDegenerate)
        state_ = latest ? Degenerate{latest->scans + 1, latest->inlierRatio}
                        : Degenerate{1, placed.inlierRatio};
    else
        state_ = Tracking{};
    // A degenerate scan may be at a wrong pose, and the next ones would confirm it: few of them
    // enter the map.
    const double moved_m = (pose_.translation() - reference_.pose.translation()).norm();
    if (isDegenerate && moved_m <= options_.spacing.doubt_spacing) return;
    if (isTimeKnown) learn(placed, predicted, since_s);
    if (hasSight) dynamics_.remember(pose_ * inverseOf(upright_));
    insertLater(view);
}

/** True where ever fewer points fit while the sensor seems to stand: in truth it moves along a
 *  horizontal axis that the scene does not show, away from where the map began. */
bool PlaneOdometry::hasDrifted(const PlaneEstimate& estimate, double inlierRatio) const {
    constexpr double kDrifted = 0.6, kHorizontal = 0.7;  // of the unit axis, along the vertical
    const auto* degenerate = std::get_if<Degenerate>(&state_);
    if (!degenerate || isCarried_ || prediction_.hasMotion()) return false;
    const Eigen::VectorXd along = estimate.translation.unobservedAxes.transpose() * upAt(pose_);
    const bool isHorizontal = (along.array().abs() < kHorizontal).any();
    return isHorizontal && inlierRatio < kDrifted * degenerate->inlierRatio;
}

/** A new map, which only a prediction links to the one before. */
void PlaneOdometry::beginAnew(const PointCloud& cloud) {
    track_ = ++latestTrack_;
    beginMap(cloud, false);
}

/** After a scan that was not found in the map. */
void PlaneOdometry::miss(const PointCloud& cloud) {
    constexpr unsigned kPatience = 3;
    const unsigned misses = missesOf(state_) + (cloud.points.cols() > 0 ? 1 : 0);
    state_ = lostFrom(std::move(state_), misses);
    if (misses < kPatience) return;
    leaveMap();
    takeScale(seenScale_);  // the map may have begun with the vehicle's own body
    beginAnew(cloud);
}

/** Learns the motion, how well it is predicted, and the usual inlier ratio. */
void PlaneOdometry::learn(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                          double since_s) {
    latestInlierRatio_ = placed.inlierRatio;
    if (prediction_.hasMotion()) {
        // A scan that fits badly where it was not expected may be at a wrong pose.
        constexpr double kForget = 0.1, kAsUsual = 0.75;
        const bool isDoubtful = placed.inlierRatio < kAsUsual * usualInlierRatio_ &&
                                stepBetween(predicted, placed.pose).norm() > kernel_m();
        if (!isDoubtful)
            usualInlierRatio_ = usualInlierRatio_ == 0 ? placed.inlierRatio
                                                       : (1 - kForget) * usualInlierRatio_ +
                                                             kForget * placed.inlierRatio;
        learnFromGyro(predicted, since_s);
        kernel_.observe(pose_, usesGyro_ ? atConstantSpeed_ : predicted);
        unevenness_.observe(reference_.pose.inverse() * pose_, prediction_.predict(since_s));
    }
    prediction_.observe(reference_.pose.inverse() * pose_, since_s);
    gyro_.observe(reference_.time_s, reference_.time_s + since_s,
                  reference_.pose.linear().transpose() * pose_.linear());
}

/** What is known of the next scan's pose, `since_s` after the latest registered scan. */
Expectation PlaneOdometry::expectation(const Eigen::Isometry3d& predicted, bool isGuess,
                                       double since_s, bool timeIsKnown) const {
    const auto& spacing = options_.spacing;
    const auto& registration = options_.registration;
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
    expected.start.metres = expected.motionIsKnown ? std::min(gained_m, driven_m) : driven_m;
    expected.start.turn_rad = std::min(spacing.first_turn_radps * since_s, spacing.most_turn_rad);
    expected.reach_m =
        timeIsKnown ? std::min(plane_tuning::kSearchSpeed_mps * since_s, registration.search_radius)
                    : registration.search_radius;
    expected.kernel_m = kernel_m();
    expected.isShaken = isShaken();
    expected.isPlacedByStanding = isPlacedByStanding(isGuess);
    expected.usualInlierRatio = usualInlierRatio_;
    return expected;
}

/** A map cannot begin before the first usable scan. */
void PlaneOdometry::begin(const PointCloud& cloud, Step& step) {
    const bool isFirst = !std::get<Empty>(state_).hasSeenScans;
    ScanView view;
    motion_ = Twist{};
    {
        const StageTimer timer(step, "map_update");
        view = beginMap(cloud, false);
    }
    // The motion since scans that could not be used is not known.
    if (!isFirst) step.reason = "no usable scan before it";
    if (std::holds_alternative<Empty>(state_))
        step.reason = cloud.points.cols() == 0 ? "no points" : "too few points";
    step.details = detailsOf({}, {});
    report(predictedEstimate(pose_), view, step);
}

/** A scan that says nothing about the motion: its pose is the prediction, and tracking goes on from
 *  the scan before. */
void PlaneOdometry::skip(const PointCloud& cloud, const Interval& interval, Step& step) {
    const Extrapolation extrapolation = predictMotion(interval.duration_s);
    pose_ = predictedByWheels(pose_ * extrapolation.at(interval.duration_s));
    motion_ = extrapolation.motion();
    ScanView view = undistorted(cloud, motion_);
    step.details = detailsOf({}, {});
    report(predictedEstimate(pose_), view, step);
}

/** Of a scan at pose_. */
void PlaneOdometry::report(const PlaneEstimate& estimate, ScanView& view, Step& step) const {
    const auto dynamic = std::count(view.dynamic.begin(), view.dynamic.end(), std::uint8_t{1});
    step.increment = incrementOf(estimate.rotation, estimate.translation);
    step.quality = qualityOf(estimate.rotation, estimate.translation);
    step.predicted = !step.reason.empty();
    const auto points = std::max<double>(1, static_cast<double>(view.dynamic.size()));
    step.details.emplace_back("dynamic", static_cast<double>(dynamic));
    step.details.emplace_back("dynamic_share", static_cast<double>(dynamic) / points);
    step.used.points = std::move(view.points);
    step.used.dynamic = std::move(view.dynamic);
}

/** The step from the stamp of the scan before to this one's, which is `stamp_s` from the scan's
 * time. `hasFoundMotion`: the motion, which was not known before, is that of the scan before, too.
 */
void PlaneOdometry::carryToStamp(double stamp_s, bool hasFoundMotion, Step& step) {
    const Eigen::Isometry3d moved = atStamp(motion_, stamp_s);
    Eigen::Isometry3d before = stamped_.pose;
    if (hasFoundMotion && !start_ && stamped_.stamp_s != 0)
        before = pose_ * atStamp(motion_, stamped_.time_s + stamped_.stamp_s - time_s_);
    stamped_ = {pose_ * moved, stamp_s, time_s_};
    step.increment.pose = normalised(before.inverse() * stamped_.pose);
    if (stamp_s == 0) return;
    const Eigen::Isometry3f toStamp = moved.inverse().cast<float>();
    step.used.points = (toStamp.linear() * step.used.points).colwise() + toStamp.translation();
}

/** A new map of this scan, at pose_. */
ScanView PlaneOdometry::beginMap(const PointCloud& cloud, bool motionIsKnown) {
    // The second scan has this one alone to be registered against: it enters as dense as it came.
    constexpr double kDense = 0.2;
    const bool isSkewed = window_.isEmpty() && !cloud.times_s.empty() && !usesGyro_;
    ScanView view = undistorted(cloud, isSkewed ? ScanTrajectory(Twist{}) : motion_);
    odometry::thin(view, kDense * options_.spacing.map_spacing, options_.spacing.scan_spacing);
    map_.clear(upAt(pose_));
    waiting_.reset();
    start_.reset();
    const bool isRetraced = window_.isEmpty() && !usesGyro_;
    if (prediction_.hasMotion() || !isRetraced) beginning_.clear();
    if (isRetraced) beginning_.push_back({{cloud, time_s_, Twist{}}, {}, track_});
    dynamics_.clear();
    usualInlierRatio_ = 0;
    map_.addScan(view.fine, pose_);
    reference_ = {view.points, pose_, time_s_};
    if (!map_.isUsable()) {
        state_ = Empty{true};
        return view;
    }
    FirstScan first;
    if (isSkewed) first.skewed = cloud;
    first.motionIsKnown = motionIsKnown;
    state_ = std::move(first);
    return view;
}

/** At pose_, while the next scan is thinned. */
void PlaneOdometry::insertLater(ScanView& view) {
    reference_ = {view.points, pose_, time_s_};
    waiting_ = PlacedPoints{std::move(view.fine), pose_};
}

void PlaneOdometry::insertWaiting() {
    if (waiting_) map_.addScan(waiting_->points, waiting_->pose);
    waiting_.reset();
}

void PlaneOdometry::takeScale(double scale) {
    scale_ = scale;
    otherScale_ = 0;
    options_ = atScale(given_, scale);
    map_ = LocalMap(options_.localMap, options_.map, options_.registration, options_.pointMap,
                    options_.points);
    waiting_.reset();
}

/** True where scans in a row show a place of another size than the map was made for: out of a house
 *  into the street. */
bool PlaneOdometry::isOtherScale() {
    constexpr double kOther = 2;
    constexpr unsigned kPatience = 10;
    const double ratio = seenScale_ / scale_;
    otherScale_ = ratio >= kOther || ratio <= 1 / kOther ? otherScale_ + 1 : 0;
    return otherScale_ >= kPatience;
}
}  // namespace delio::odometry
