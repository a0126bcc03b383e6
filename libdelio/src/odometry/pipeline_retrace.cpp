#include <algorithm>
#include <utility>
#include <vector>

#include "odometry/pipeline.h"
#include "odometry/preprocess.h"
#include "odometry/reporting.h"

namespace delio::odometry {
namespace {
/** Scans that are registered again, at least, and those that follow them. */
constexpr std::size_t kFirst = 4, kLater = 4;

bool hasTimes(const PointCloud& cloud) { return !cloud.times_s.empty(); }

/** The scan as a sensor that moves backwards through time takes it. */
PointCloud reversed(PointCloud cloud) {
    for (float& time_s : cloud.times_s) time_s = -time_s;
    cloud.stamp_s = -cloud.stamp_s;
    return cloud;
}

ScanTrajectory reversed(const ScanTrajectory& trajectory) {
    auto times_s = trajectory.times_s();
    auto poses = trajectory.poses();
    for (double& time_s : times_s) time_s = -time_s;
    std::reverse(times_s.begin(), times_s.end());
    std::reverse(poses.begin(), poses.end());
    return {times_s, poses};
}
}  // namespace

/** Adds the latest scan to beginning_. False where the first ones cannot be registered again. */
bool PlaneOdometry::extendBeginning(const PointCloud& cloud, const Step& step) {
    constexpr std::size_t kMost = 40;
    if (beginning_.back().scan.time_s != time_s_) {
        const bool isSkipped = !step.reason.empty() && missesOf(state_) == 0,
                   isMissing = !step.reason.empty() && prediction_.hasMotion();
        if (isSkipped || isMissing || isUrgent_ || left_ ||
            hasTimes(cloud) != hasTimes(beginning_.back().scan.cloud))
            return false;
        const bool isTracking = std::holds_alternative<Tracking>(state_) && waiting_;
        beginning_.push_back({{cloud, time_s_, trajectoryOfLatest()},
                              isTracking ? waiting_ : std::nullopt,
                              track_,
                              inlierRatios_.planes});
    }
    if (start_)
        for (auto& [scan, points, track, onPlanes] : beginning_)
            if (track == track_)
                scan.trajectory = placed(window_.trajectory().at(scan.time_s),
                                         window_.trajectory().seenFrom(scan.time_s));
    return beginning_.size() < kMost;
}

/** Inlier ratio on planes: the median of the map's latest five scans; nothing before these. */
std::optional<double> PlaneOdometry::latestOnPlanes() const {
    constexpr std::size_t kScans = 5;
    std::vector<double> latest;
    for (auto scan = beginning_.rbegin(); scan != beginning_.rend() && scan->onPlanes; ++scan)
        latest.push_back(*scan->onPlanes);
    if (latest.size() < kScans) return {};
    latest.resize(kScans);
    std::sort(latest.begin(), latest.end());
    return latest[kScans / 2];
}

/** The first scans of a map were registered to few others, and while the motion was not known. As
 *  soon as more scans have followed, the first ones are registered again, to those and backwards in
 *  time, with a motion that is known. Where the sensor turns, this waits until a gyroscope may be
 *  trusted.
 *
 *  A few rings on rough ground lie on those of the scan before at a wrong tilt, too, and the scans
 *  that follow confirm it. Then planes hold badly for them, and a new map begins. */
void PlaneOdometry::retraceStart(const PointCloud& cloud, const Step& step) {
    constexpr std::size_t kUntilGyro = 6, kDoubtful = 15, kFresh = 32;
    constexpr double kTilted = 0.7, kGood = 0.85;  // inlier ratio on planes
    constexpr double kFar_m = 3;
    if (beginning_.empty()) return;
    if (!extendBeginning(cloud, step)) return beginning_.clear();
    const auto onPlanes = latestOnPlanes();
    const auto isBelow = [&](double least) { return !usesGyro_ && onPlanes && *onPlanes < least; };
    if (isBelow(kTilted) && !isLost(state_) && beginning_.size() < kFresh) {
        beginning_.pop_back();
        prediction_.forget();
        return beginAnew(cloud);
    }
    const auto isTracked = [](const BeginningScan& scan) { return scan.points.has_value(); };
    const auto tracked = static_cast<std::size_t>(
        std::find_if_not(beginning_.rbegin(), beginning_.rend(), isTracked) - beginning_.rbegin());
    const std::size_t more = gyro_.hasTurned() ? kUntilGyro : 0;
    if (tracked + 1 < kFirst + kLater + more) return;
    // While the sensor hardly moves, few planes hold at a wrong tilt, too. A later map does not
    // wait for the motion: it has to be linked to the one before it.
    const bool wasTracked = tracked + 1 >= beginning_.size();
    const Eigen::Vector3d first = beginning_.front().scan.trajectory.at(0).translation();
    const bool isTested = !isBelow(kGood) && (!wasTracked || planeMatches_ >= kManyPlanes ||
                                              (pose_.translation() - first).norm() > kFar_m);
    if (!isTested && tracked < kDoubtful && !usesGyro_) return;
    // Scans that need no de-skewing are registered well from the second one on, if planes hold.
    const auto isGood = [](const BeginningScan& scan) {
        return !scan.onPlanes || *scan.onPlanes >= kGood;
    };
    const bool wereGood = std::all_of(beginning_.begin(), beginning_.end(), isGood);
    if (!hasTimes(cloud) && wasTracked && wereGood) return beginning_.clear();
    mayRetrace_ = true;
    if (!wasTracked) retrace();  // the drive may end before maps are linked
}

/** What retraceStart() decided. At a usual start it comes after the pose of the latest scan and
 *  before anything of the next one: a live sensor's pose does not wait for it. */
void PlaneOdometry::retrace() {
    if (!std::exchange(mayRetrace_, false)) return;
    registerStartAgain(beginning_.size() - kLater);
    beginning_.clear();
}

/** Registers the first `count` scans of beginning_ again, the last of them first, as far as they
 *  are found; those before move along. Nothing is corrected where few are found. */
void PlaneOdometry::registerStartAgain(std::size_t count) {
    auto& past = path_.scans();
    const double first_s = beginning_.front().scan.time_s;
    const auto known = static_cast<std::size_t>(
        std::find_if(past.begin(), past.end(),
                     [&](const ReportedPath::Scan& scan) { return scan.time_s == first_s; }) -
        past.begin());
    // The latest scan comes in with the report. (Stamps may have been the same.)
    const std::size_t scans = past.size() - known;
    if (scans != beginning_.size() && scans + 1 != beginning_.size()) return;
    PlaneOdometry back(place_.given());
    back.turnBack(*this, count);
    std::vector<ScanTrajectory> trajectories(count + 1, beginning_[count].scan.trajectory);
    std::size_t first = count;
    while (first > 0) {
        const auto found = back.stepBack(beginning_[first - 1].scan);
        if (!found) break;
        trajectories[--first] = *found;
    }
    if (count - first < kFirst) return;
    const Anchor held = past[known].at;
    // The trajectory of a scan is known best between its time and that of the scan after it. A
    // stamp of the scan that comes next may lie there, too.
    for (std::size_t i = first, k = first; i <= count; ++i) {
        ReportedPath::Scan& scan = past[known + i];
        while (k < count && beginning_[k + 1].scan.time_s <= scan.stamp_s) ++k;
        if (i == count && k == count) break;
        scan.at.pose = atStamp(trajectories[k], scan.stamp_s - beginning_[k].scan.time_s);
        scan.isRegistered = true;
    }
    const Eigen::Isometry3d moved =
        trajectories[first].at(0) * beginning_[first].scan.trajectory.at(0).inverse();
    for (std::size_t i = 0; i < first; ++i)
        past[known + i].at.pose = moved * past[known + i].at.pose;
    if (first == 0) track_ = beginning_.front().track;
    back.insertWaiting();
    map_ = std::move(back.map_);
    waiting_.reset();
    // The first of the scans stays where it was said to be: the next step leads to where the sensor
    // is now.
    const Eigen::Isometry3d toMap = past[known].at.pose * held.pose.inverse();
    for (std::size_t i = 0; i < past.size(); ++i) {
        if (i < known) past[i].at.pose = toMap * past[i].at.pose;
        past[i].isCorrected = i >= known;
    }
    path_.moveTo({past[known].at.pose, held.reported});
}

/** Begins with the scans from number `first` on that follow a start, in reverse order. */
void PlaneOdometry::turnBack(const PlaneOdometry& ahead, std::size_t first) {
    upright_ = ahead.upright_;
    takeScale(ahead.place_.scale());
    gyro_ = ahead.gyro_.reversed();
    gyroErrors_ = ahead.gyroErrors_;
    speeds_.reset();
    errors_.kernel = ahead.errors_.kernel;
    constexpr std::size_t kSettled = 5;  // scans since the motion is known well
    errors_.unevenness = ahead.errors_.unevenness.ofLatest(kSettled);
    inlierRatios_.usual = ahead.inlierRatios_.usual;
    const auto& scans = ahead.beginning_;
    map_.clear(ahead.upAt(scans[first].points->pose));
    for (std::size_t i = scans.size(); i-- > first;) {
        const auto& [fine, pose] = *scans[i].points;
        map_.addScan(fine, pose);
        if (i + 1 < scans.size())
            prediction_.observe(scans[i + 1].points->pose.inverse() * pose,
                                scans[i + 1].scan.time_s - scans[i].scan.time_s);
    }
    const MovingScan& next = scans[first].scan;
    pose_ = scans[first].points->pose;
    time_s_ = -next.time_s;
    MovingScan latest{reversed(next.cloud), time_s_, reversed(next.trajectory)};
    motion_ = latest.trajectory.seenFrom(0);
    reference_ = {undistorted(latest.cloud, motion_).points, pose_, time_s_};
    if (hasTimes(latest.cloud)) latest_ = std::move(latest);
    state_ = Tracking{};
}

/** Registers the scan before the latest one, from where the motion leads and from where it was
 * found before. The sensor's trajectory during it (sensor to map, times from the scan's); nothing
 * where the scan is not found, or fitted clearly better before. */
std::optional<ScanTrajectory> PlaneOdometry::stepBack(const MovingScan& scan) {
    PointCloud cloud = reversed(scan.cloud);
    const double duration_s = -scan.time_s - time_s_;
    time_s_ = -scan.time_s;
    Step step;
    step.times_ms = noTimes();
    step.deskewed = hasTimes(cloud);
    Attempt attempt = attemptToTrack(cloud, {IntervalKind::kUsual, duration_s, duration_s}, step);
    if (!attempt.placement.isLikely) {
        const ScanTrajectory before = reversed(scan.trajectory);
        Attempt asBefore = attemptBy(cloud, expectation(before.at(0), false, duration_s, true),
                                     before.seenFrom(0), step);
        // Scans that were taken for those of a sensor that stood lie on each other better.
        if (asBefore.isBetterThan(attempt)) {
            endWindow();
            usesGyro_ = false;
            attempt = std::move(asBefore);
        }
    }
    track(cloud, std::move(attempt), step);
    if (!step.reason.empty()) return {};
    settleWindow(step);
    keep(std::move(cloud), step);
    return reversed(trajectoryOfLatest());
}
}  // namespace delio::odometry
