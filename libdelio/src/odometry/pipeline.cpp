#include "odometry/pipeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "odometry/preprocess.h"
#include "odometry/reporting.h"
#include "odometry/spin_axis.h"

namespace delio::odometry {
namespace {
Eigen::Isometry3d inverseOf(const Eigen::Matrix3f& rotation) {
    return Eigen::Isometry3d(rotation.transpose().cast<double>());
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

/** The planes constrained the scan. */
bool isOnPlanes(const PlaneEstimate& estimate) {
    return estimate.valid && estimate.rotation.observability[2] > 0;
}

/** The figures of both registrations. */
std::vector<Named> detailsOf(const PlaneEstimate& estimate, const PointEstimate& placed) {
    const bool byPlanes = isOnPlanes(estimate);
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
    : place_(options),
      arrivals_(needsTimes(options.scan)),
      map_(LocalMapTuning(), options.map, options.registration, options.pointMap, options.points),
      dynamics_(options.dynamics),
      speeds_(std::in_place, SpacingTuning().first_speed, 1.25 * options.points.last_kernel),
      prediction_(options.prediction) {}

Step PlaneOdometry::process(const Scan& scan) {
    requireConsistent(scan);
    retrace();
    findOwn();
    Step step;
    step.times_ms = noTimes();
    PointCloud cloud = prepare(scan, step);
    const Interval interval = arrive(scan, cloud, step);

    const bool motionWasKnown = !isLost(state_);
    if (std::holds_alternative<Empty>(state_))
        begin(cloud, interval, step);
    else if (!step.reason.empty())
        skip(cloud, interval, step);
    else
        track(cloud, attemptToTrack(cloud, interval, step), step);
    retraceStart(cloud, step);

    if (motionWasKnown) correctStampBefore(cloud, step);
    const bool hasFoundMotion = !motionWasKnown && !step.predicted && !step.interrupted;
    extendPath(cloud.stamp_s, hasFoundMotion, step);
    step.standing = isStanding(step, interval.duration_s);
    step.lost = isLostAfter(step);
    step.track = track_;
    finish(std::move(cloud), step);
    return step;
}

/** The scan without the points that no stage uses. The first one says which way is up. */
PointCloud PlaneOdometry::prepare(const Scan& scan, Step& step) {
    const StageTimer timer(step, "preprocess");
    const bool isEmpty = std::holds_alternative<Empty>(state_);
    place_.see(scan);
    if (isEmpty) takeScale(place_.seen());
    PointCloud cloud = own_.without(preprocess(scan, options().scan));
    countFromMiddle(cloud);
    if (isEmpty) upright_ = uprightOf(scan.sensorPose, cloud.points);
    step.notFinite = cloud.notFinite;
    step.deskewed = !cloud.times_s.empty();
    return cloud;
}

/** The time since the scan before, and whether the scan can be used (Step::reason). Gyroscope and
 *  wheels follow as far. */
Interval PlaneOdometry::arrive(const Scan& scan, const PointCloud& cloud, Step& step) {
    const Arrival arrival = arrivals_.take(scan, scan.stamp_s - cloud.stamp_s);
    time_s_ = arrivals_.sinceStart_s();
    unregistered_s_ += arrival.interval.elapsed_s;
    const ScanClock clock{time_s_, arrival.time_s, endsOf(cloud).second};
    isUrgent_ = scan.dropped > 0;
    usesGyro_ = false;
    gyro_.advance(clock, scan.sensorPose);
    wheels_.advance(clock, scan.sensorPose, path_.latest().time_s);
    if (std::holds_alternative<Empty>(state_)) return arrival.interval;
    step.interrupted = arrival.interval.kind == IntervalKind::kUnknown;
    if (step.interrupted) interrupt(arrival.interval.elapsed_s);
    step.reason = reasonToSkip(arrival, prediction_);
    return arrival.interval;
}

/** Leaves what the next scan needs. */
void PlaneOdometry::finish(PointCloud cloud, Step& step) {
    if (!step.predicted) unregistered_s_ = 0;
    if (!isLost(state_) && place_.isOther() && !step.predicted) {
        retrace();
        takeScale(place_.seen());
        beginMap(cloud, !std::holds_alternative<Degenerate>(state_));
    }
    step.details.emplace_back("scale", place_.scale());
    gyro_.count(usesGyro_);
    step.used.indices = std::move(cloud.indices);
    keep(std::move(cloud), step);
}

/** After a pause, or a clock that was set. */
void PlaneOdometry::interrupt(double elapsed_s) {
    constexpr double kLongest_s = 3.5;  // longer, the motion is not extrapolated
    if (elapsed_s > kLongest_s) prediction_.forget();
    reference_.isBeforePause = true;
    const unsigned misses = missesOf(state_);
    state_ = lostFrom(std::move(state_), misses);
}

/** A degenerate scan is not lost while the motion is known. */
bool PlaneOdometry::isLostAfter(const Step& step) const {
    constexpr unsigned kPatience = 3;
    if (const auto* degenerate = std::get_if<Degenerate>(&state_))
        return !wheels_.haveCarried() && !prediction_.hasMotion() && degenerate->scans >= kPatience;
    return step.predicted && missesOf(state_) > 0;
}

/** The method: a scan against the map of earlier scans. */
void PlaneOdometry::track(const PointCloud& cloud, Attempt attempt, Step& step) {
    const double since_s = time_s_ - reference_.time_s;
    auto& [predicted, extrapolated, motion, view, sight, placement] = attempt;
    motion_ = motion;
    const PointEstimate& placed = placement.estimate;
    step.searched = placement.searched;
    step.interrupted = step.interrupted || isBeyondReach(placed, predicted, since_s);

    const bool hasSight = sight && placed.valid;
    if (hasSight) {
        const StageTimer timer(step, "dynamic");
        removeDynamicObjects(std::move(*sight), placed.pose, view);
    }
    const auto estimate = registerByPlanes(cloud, placed, predicted, since_s, view, step);
    planeMatches_ = estimate.isByPlanes ? estimate.translation.matches : 0;
    inlierRatios_.planes = isOnPlanes(estimate) ? estimate.inlierRatio : 0;

    pose_ = estimate.valid ? estimate.pose() : wheels_.carried(pose_, predicted);
    countMisfits(estimate, placed.inlierRatio, since_s);
    {
        const StageTimer timer(step, "map_update");
        if (estimate.valid)
            update(estimate, placed, extrapolated, since_s, hasSight, view, step);
        else
            miss(cloud);
        if (left_ && estimate.valid) rejoin(view);
        if (!settleSpeed(cloud, estimate) && hasDrifted(estimate, placed.inlierRatio))
            beginAnew(cloud);
    }
    if (!estimate.valid)
        step.reason = cloud.points.cols() == 0 ? "no points" : "not found in the map";
    step.details = detailsOf(estimate, placed);
    report(estimate, view, step);
}

/** From the thinned scan, whose pose is known by points. */
void PlaneOdometry::removeDynamicObjects(DynamicObjects::Sight sight, const Eigen::Isometry3d& pose,
                                         ScanView& view) {
    auto dynamic = dynamics_.detect(std::move(sight), pose * inverseOf(upright_), time_s_);
    map_.erase(dynamics_.unmasked());
    leaveOutDynamic(view, std::move(dynamic));
}

PlaneEstimate PlaneOdometry::registerByPlanes(const PointCloud& cloud, const PointEstimate& placed,
                                              const Eigen::Isometry3d& predicted, double since_s,
                                              ScanView& view, Step& step) {
    const StageTimer timer(step, "planes");
    if (!placed.valid) return predictedEstimate(predicted);
    const bool isDeskewed = step.deskewed && !step.interrupted && window_.isEmpty();
    const auto deskewFrom = [&](const Eigen::Isometry3d& pose) {
        return deskewAgain(cloud, since_s, placed, predicted, pose, view);
    };
    std::optional<ScanOnTrajectory> deskewed;
    // Where planes are many, they bend the trajectory from where the points lead.
    if (isDeskewed && isSettled() && haveManyPlanes()) deskewed = deskewFrom(placed.pose);
    if (!deskewed || !deskewed->estimate.isByPlanes) {
        thinForPlanes(view);
        auto found = map_.registerPlanes(view, placed, predicted, motion());
        wheels_.carry(pose_, found);
        if (isDeskewed) deskewed = deskewFrom(found.pose());
        if (!isDeskewed || !deskewed) return found;
    }
    wheels_.carry(pose_, deskewed->estimate);
    view = std::move(deskewed->view);
    motion_ = deskewed->trajectory.seenFrom(0);
    extrapolation_ = Extrapolation(motion_, since_s / 8);
    return deskewed->estimate;
}

/** No vehicle moves so: scans are missing before this one, whatever their stamps say. */
bool PlaneOdometry::isBeyondReach(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                                  double since_s) const {
    const double most_m =
        options().points.first_kernel + options().spacing.acceleration / 2 * since_s * since_s;
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
    if (isDegenerate && moved_m <= options().spacing.doubt_spacing) return;
    if (isTimeKnown) learn(placed, predicted, since_s);
    if (hasSight) dynamics_.remember(pose_ * inverseOf(upright_));
    insertLater(view);
}

/** True where ever fewer points fit while the sensor seems to stand: in truth it moves along a
 *  horizontal axis that the scene does not show, away from where the map began. */
bool PlaneOdometry::hasDrifted(const PlaneEstimate& estimate, double inlierRatio) const {
    constexpr double kDrifted = 0.6, kHorizontal = 0.7;  // of the unit axis, along the vertical
    const auto* degenerate = std::get_if<Degenerate>(&state_);
    if (!degenerate || wheels_.haveCarried() || prediction_.hasMotion()) return false;
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
    const auto least = static_cast<Eigen::Index>(options().points.min_matches);
    if (misses < kPatience || cloud.points.cols() < least) return;  // too few begin no map
    leaveMap();
    takeScale(place_.seen());  // the map may have begun with the vehicle's own body
    beginAnew(cloud);
}

/** Learns the motion, how well it is predicted, and the usual inlier ratio. */
void PlaneOdometry::learn(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                          double since_s) {
    inlierRatios_.latest = placed.inlierRatio;
    if (prediction_.hasMotion()) {
        // A scan that fits badly where it was not expected may be at a wrong pose.
        constexpr double kForget = 0.1, kAsUsual = 0.75;
        const bool isDoubtful = placed.inlierRatio < kAsUsual * inlierRatios_.usual &&
                                stepBetween(predicted, placed.pose).norm() > kernel_m();
        double& usual = inlierRatios_.usual;
        if (!isDoubtful)
            usual = usual == 0 ? placed.inlierRatio
                               : (1 - kForget) * usual + kForget * placed.inlierRatio;
        learnFromGyro(predicted, since_s);
        errors_.kernel.observe(pose_, usesGyro_ ? atConstantSpeed_ : predicted);
        errors_.unevenness.observe(reference_.pose.inverse() * pose_, prediction_.predict(since_s));
    }
    prediction_.observe(reference_.pose.inverse() * pose_, since_s);
    gyro_.observe(reference_.time_s, reference_.time_s + since_s,
                  reference_.pose.linear().transpose() * pose_.linear());
}

/** A map cannot begin before the first usable scan. */
void PlaneOdometry::begin(const PointCloud& cloud, const Interval& interval, Step& step) {
    const bool isFirst = !std::get<Empty>(state_).hasSeenScans;
    ScanView view;
    const Extrapolation extrapolation = predictMotion(interval.duration_s);
    pose_ = wheels_.carried(pose_, pose_ * extrapolation.at(interval.duration_s));
    motion_ = extrapolation.motion();
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
    pose_ = wheels_.carried(pose_, pose_ * extrapolation.at(interval.duration_s));
    motion_ = extrapolation.motion();
    ScanView view = undistorted(cloud, motion_);
    step.details = detailsOf({}, {});
    report(predictedEstimate(pose_), view, step);
}

/** Of a scan at pose_. */
void PlaneOdometry::report(const PlaneEstimate& estimate, ScanView& view, Step& step) const {
    const auto dynamic = std::count(view.dynamic.begin(), view.dynamic.end(), std::uint8_t{1});
    TranslationEstimate translation = estimate.translation;
    if (const auto axes = axesOfVehicles(estimate); axes.cols() > 0) {
        translation.unobservedAxes = axes;
        translation.covariance +=
            std::pow(options().registration.prior_sigma, 2) * axes * axes.transpose();
    }
    step.increment = incrementOf(estimate.rotation, translation);
    step.quality = qualityOf(estimate.rotation, translation);
    step.predicted = !step.reason.empty();
    const auto points = std::max<double>(1, static_cast<double>(view.dynamic.size()));
    step.details.emplace_back("dynamic", static_cast<double>(dynamic));
    step.details.emplace_back("dynamic_share", static_cast<double>(dynamic) / points);
    step.used.points = std::move(view.points);
    step.used.dynamic = std::move(view.dynamic);
}

/** A stamp after the scan's time (a driver stamped the end of the turn) lies in the motion that the
 *  next scan shows. */
void PlaneOdometry::correctStampBefore(const PointCloud& cloud, const Step& step) {
    const Stamped& before = path_.latest();
    const double since_s = before.sinceStart_s() - time_s_;
    const bool isBetween = before.stamp_s > 0 && since_s < endsOf(cloud).second;
    if (isBetween && step.deskewed && !step.predicted && !step.interrupted)
        path_.correctStamp(pose_ * atStamp(motion_, since_s));
}

/** The step from the stamp of the scan before to this one's, which is `stamp_s` from the scan's
 *  time, and corrections of earlier ones. `hasFoundMotion`: the motion, which was not known before,
 *  is that of the scan before, too. */
void PlaneOdometry::extendPath(double stamp_s, bool hasFoundMotion, Step& step) {
    settleWindow(step);
    // The first scan stays where it was said to be.
    if (start_) path_.moveTo({window_.trajectory().at(start_->stamp_s), start_->reported});
    const Eigen::Isometry3d moved = atStamp(motion_, stamp_s);
    const Stamped latest = path_.latest();
    Eigen::Isometry3d before = latest.pose;
    if (hasFoundMotion && !start_ && latest.stamp_s != 0)
        before = pose_ * atStamp(motion_, latest.sinceStart_s() - time_s_);
    step.increment.pose = path_.advance({pose_ * moved, stamp_s, time_s_}, before);
    if (stamp_s != 0) {
        const Eigen::Isometry3f toStamp = moved.inverse().cast<float>();
        step.used.points = (toStamp.linear() * step.used.points).colwise() + toStamp.translation();
    }
    if (start_) path_.correctSince(start_->stamp_s, window_.trajectory());
    path_.report(step);
    step.carried = wheels_.haveCarried();
    wheels_.learn(isObserved(step), latest.sinceStart_s(), path_.latest().sinceStart_s(),
                  step.increment.pose);
}

/** A new map of this scan, at pose_. */
ScanView PlaneOdometry::beginMap(const PointCloud& cloud, bool motionIsKnown) {
    // The second scan has this one alone to be registered against: it enters as dense as it came.
    constexpr double kDense = 0.2;
    const bool isSkewed = window_.isEmpty() && !cloud.times_s.empty() && !usesGyro_;
    ScanView view = undistorted(cloud, isSkewed ? ScanTrajectory(Twist{}) : motion_);
    thinForMap(view, kDense * options().spacing.map_spacing);
    map_.clear(upAt(pose_));
    waiting_.reset();
    start_.reset();
    if (prediction_.hasMotion() || usesGyro_) beginning_.clear();
    if (window_.isEmpty() && !usesGyro_)
        beginning_.push_back({{cloud, time_s_, placed(pose_, Twist{})}, {}, track_});
    dynamics_.clear();
    inlierRatios_.usual = 0;
    misfits_ = 0;
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

/** After a scan that was registered, at pose_, before it becomes the reference. */
void PlaneOdometry::learnFromGyro(const Eigen::Isometry3d& predicted, double since_s) {
    if (!usesGyro_) return;
    gyroErrors_.kernel.observe(pose_, predicted);
    const auto turned = gyro_.rotation(time_s_ - since_s, time_s_);
    if (!turned) return;
    const Eigen::Isometry3d even = isometry(*turned, prediction_.predict(since_s).translation());
    gyroErrors_.unevenness.observe(reference_.pose.inverse() * pose_, even);
}

/** True where the scan showed every axis, and no earlier one has moved. */
bool PlaneOdometry::isObserved(const Step& step) const {
    const bool hasMoved =
        std::any_of(step.corrected.begin(), step.corrected.end(),
                    [](const CorrectedPose& corrected) { return !corrected.staysInPlace; });
    return std::holds_alternative<Tracking>(state_) && !step.predicted && !step.interrupted &&
           !hasMoved && step.quality.unobservedTranslation.cols() == 0;
}

/** Before a map of that scale begins. */
void PlaneOdometry::takeScale(double scale) {
    place_.use(scale);
    map_ = LocalMap(options().localMap, options().map, options().registration, options().pointMap,
                    options().points);
    waiting_.reset();
}
}  // namespace delio::odometry
