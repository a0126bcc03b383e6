#include <utility>

#include "odometry/pipeline.h"
#include "odometry/preprocess.h"
#include "odometry/reporting.h"

namespace delio::odometry {
/** Registers the scan together with those before it. `found`: where the map alone places it, in
 *  case that the window is empty. False where no motion was found, or the second scan shows none
 *  that changes. */
bool PlaneOdometry::extendWindow(const PointCloud& cloud, double since_s, const Placement& found,
                                 Step& step) {
    const StageTimer timer(step, "undistort");
    constexpr double kFastestHand_mps = 5;
    if (!window_.isEmpty()) {
        if (window_.isFull()) start_.reset();
        if (!window_.add(cloud, time_s_)) endWindow();
        return !window_.isEmpty();
    }
    if (auto* first = std::get_if<FirstScan>(&state_); first && first->skewed) {
        const auto& at = reference_.pose;
        Twist guess;
        if (found.estimate.valid) guess = Twist::of(at.inverse() * found.estimate.pose, since_s);
        if (found.isLikely && guess.velocity.norm() > kFastestHand_mps) return false;
        prepare(*first);
        window_.begin(*std::exchange(first->timed, {}), ScanTrajectory({0, 1}, {at, at}));
        if (window_.addSecond(cloud, time_s_, guess, found.isLikely))
            start_ = Start{path_.latest().sinceStart_s(), path_.anchor().reported};
        else
            window_.clear();
    } else if (latest_ && prediction_.predict(1).translation().norm() < kFastestHand_mps) {
        window_.begin(timedScanOf(latest_->cloud, latest_->time_s), latest_->trajectory);
        if (!window_.add(cloud, time_s_)) endWindow();
    }
    return !window_.isEmpty();
}

/** The scan placed by points near where the window has it. */
PlaneOdometry::Attempt PlaneOdometry::attemptInWindow(const PointCloud& cloud, double since_s,
                                                      Step& step) {
    if (start_) beginMapAgain();
    const Eigen::Isometry3d pose = window_.trajectory().at(time_s_);
    Expectation expected = expectation(pose, false, since_s, true);
    expected.isShaken = expected.isPlacedByStanding = false;
    expected.kernel_m = options().points.least_kernel;
    return attemptBy(cloud, expected, window_.trajectory().seenFrom(time_s_), step);
}

/** The better of `first` and of the scan where the window finds it from other rates of turn. */
PlaneOdometry::Attempt PlaneOdometry::attemptAgain(const PointCloud& cloud, double since_s,
                                                   Attempt first, Step& step) {
    const ScanTrajectory before = window_.trajectory();
    if (!window_.search()) return first;
    Attempt again = attemptInWindow(cloud, since_s, step);
    if (again.isBetterThan(first)) return again;
    window_.use(before);
    if (start_) beginMapAgain();
    return first;
}

/** The map of the window's scans but the latest, each where it is now. */
void PlaneOdometry::beginMapAgain() {
    const auto& trajectory = window_.trajectory();
    const auto& scans = window_.scans();
    map_.clear(upAt(trajectory.at(scans.front().time_s)));
    waiting_.reset();
    for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
        pose_ = trajectory.at(scans[i].time_s);
        ScanView view = undistorted(scans[i].cloud, trajectory.seenFrom(scans[i].time_s));
        thinForMap(view, options().spacing.map_spacing);
        map_.addScan(view.fine, pose_);
        reference_ = {view.points, pose_, scans[i].time_s};
    }
    if (auto* first = std::get_if<FirstScan>(&state_)) first->skewed.reset();
    // The next step leads from where the latest one ended to where the sensor is now.
    path_.moveTo({trajectory.at(start_->stamp_s), start_->reported});
}

/** After a scan, at pose_. */
void PlaneOdometry::settleWindow(const Step& step) {
    if (window_.isEmpty()) return;
    if (!step.predicted) window_.moveTo(pose_);
    if (errors_.kernel.isKnown() && !isShaken()) endWindow();
}

void PlaneOdometry::endWindow() {
    window_.clear();
    start_.reset();
}

/** The scan as it came, for a window that may begin with it, and to find the own vehicle in it. */
void PlaneOdometry::keep(PointCloud cloud, const Step& step) {
    latest_.reset();
    const bool showsOwn = options().dynamics.enabled && std::holds_alternative<Tracking>(state_);
    if (cloud.times_s.empty() || step.predicted || step.interrupted || !window_.isEmpty()) {
        if (showsOwn) own_.add(cloud.points, upright_, pose_);
        return;
    }
    latest_ = MovingScan{std::move(cloud), time_s_, trajectoryOfLatest()};
    mayShowOwn_ = showsOwn;
}

void PlaneOdometry::findOwn() {
    if (std::exchange(mayShowOwn_, false)) own_.add(latest_->cloud.points, upright_, pose_);
}

/** For a window that may begin with it. */
void PlaneOdometry::prepare(FirstScan& first) const {
    if (first.skewed && !first.timed) first.timed = timedScanOf(*first.skewed, reference_.time_s);
}

void PlaneOdometry::settle() {
    retrace();
    insertWaiting();
    if (!isUrgent_) map_.prepare();
    if (auto* first = std::get_if<FirstScan>(&state_)) prepare(*first);
    findOwn();
}
}  // namespace delio::odometry
