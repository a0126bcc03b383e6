#include "delio/odometry/plane_odometry.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <utility>

#include "delio/core/stopwatch.h"
#include "delio/odometry/scale.h"
#include "delio/odometry/scan_course.h"
#include "delio/scan/spin_axis.h"
#include "delio/scan/voxel_grid.h"

namespace delio {
using planes::PlaneEstimate;
using points::PointEstimate;

namespace {
Eigen::Isometry3d turnedBack(const Eigen::Matrix3f& upright) {
    return Eigen::Isometry3d(upright.transpose().cast<double>());
}

/** What every scan's step has, whether the stage was gone through or not. */
std::vector<Named> noTimes() {
    return {{"preprocess", 0}, {"undistort", 0}, {"thinning", 0},  {"points", 0},
            {"dynamic", 0},    {"planes", 0},    {"map_update", 0}};
}

/** True for a scan that was registered along and about every axis and moved slower than
 * registration noise over one turn. */
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
    return {{"inlier_ratio", placed.share},
            {"kernel_m", placed.kernel_m},
            {"iterations", static_cast<double>(placed.iterations)},
            {"converged", static_cast<double>(placed.converged)},
            {"plane_inlier_ratio", byPlanes ? estimate.share : 0},
            {"plane_iterations", byPlanes ? static_cast<double>(rotation.iterations) : 0},
            {"plane_converged", byPlanes ? static_cast<double>(rotation.converged) : 0}};
}
}  // namespace

PlaneOdometry::PlaneOdometry(const PlaneOdometryOptions& options)
    : given_(options),
      options_(options),
      arrivals_(needsTimes(options.scan)),
      prediction_(options.prediction),
      map_(options.scanToMap, options.map, options.registration, options.pointMap, options.points),
      dynamics_(options.dynamics, options.segments) {}

void PlaneOdometry::takeScale(double scale) {
    scale_ = scale;
    otherScale_ = 0;
    options_ = atScale(given_, scale);
    map_ = ScanToMap(options_.scanToMap, options_.map, options_.registration, options_.pointMap,
                     options_.points);
    awaited_.reset();
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

/** Thins the whole scan while the one before it comes into the map; says which points became
 *  which. */
scan::VoxelNumbers PlaneOdometry::thinAll(ScanView& view) {
    const auto& spacings = options_.tracker;
    scan::VoxelNumbers voxels;
    const auto thinIt = [&] {
        voxels = scan::numberVoxels(view.points, spacings.map_spacing);
        view.fine = scan::centroidsOf(view.points, voxels);
        view.coarse = scan::firstOfVoxels(view.fine, spacings.point_spacing).cast<double>();
    };
    tbb::parallel_invoke([&] { settle(); }, thinIt);
    return voxels;
}

/** Takes what moves out of the thinned scan, whose pose is known by points. */
void PlaneOdometry::leaveOutDynamicObjects(const scan::VoxelNumbers& voxels,
                                           movers::DynamicObjects::Sight sight,
                                           const Eigen::Isometry3d& pose, ScanView& view) {
    const auto dynamic =
        dynamics_.detect(std::move(sight), pose * turnedBack(upright_), arrivals_.sinceStart_s());
    map_.erase(dynamics_.unmasked());
    for (std::size_t i = 0; i < view.dynamic.size(); ++i)
        view.dynamic[i] = dynamic[voxels.ofPoint[i]];
    view.fine = unmarked(view.fine, dynamic);
}

/** What is known of the next scan's place, of which `since_s` is the time since the latest one that
 *  was registered. */
Expectation PlaneOdometry::expectation(const Eigen::Isometry3d& predicted, double since_s,
                                       bool believed) const {
    const auto& tracker = options_.tracker;
    const auto& points = options_.points;
    const auto& registration = options_.registration;
    // What was driven in more time than this, surfaces have to find.
    constexpr double kLongest_s = 0.5;
    const double driven_m = tracker.first_speed * std::min(since_s, kLongest_s),
                 gained_m = tracker.acceleration / 2 * since_s * since_s;
    Expectation expected{predicted, reference_, upright_};
    expected.motionIsKnown = prediction_.hasMotion();
    expected.isGuess = lost_ || doubted_ || !expected.motionIsKnown;
    expected.start_m = expected.motionIsKnown ? std::min(gained_m, driven_m) : driven_m;
    expected.reach_m =
        believed ? std::min(registration.search_speed * since_s, registration.search_radius)
                 : registration.search_radius;
    expected.kernel_m = kernel_.width(points.least_kernel, points.first_kernel);
    expected.isShaken = kernel_.isKnown() && expected.kernel_m >= points.first_kernel;
    expected.usualShare = usualShare_;
    return expected;
}

Course PlaneOdometry::courseOf(const KnownMotion& known, const scan::PointCloud& cloud,
                               const ScanView& view) const {
    const auto& points = options_.points;
    return findCourse(map_.planes(), known, cloud, view, unevenness_,
                      kernel_.width(points.least_kernel, points.first_kernel), options_);
}

/** The scan that the map began with, which is all there is in it, as it was seen on this course. */
void PlaneOdometry::undistortFirst(const Course& course) {
    ScanView first = undistorted(*skewed_, course);
    thin(first, options_.tracker.map_spacing, options_.tracker.scan_spacing);
    map_.clear(upAt(reference_.pose));
    map_.add(first.fine, reference_.pose);
    reference_.points = std::move(first.points);
}

/** The second scan, of which the first tells the motion, and which tells the first one's. Each part
 *  of a first scan that is skewed bends the course as it is itself: both are undistorted again and
 *  again, as long as more points fit. */
std::optional<ScanOnCourse> PlaneOdometry::undistortPair(KnownMotion known,
                                                         const scan::PointCloud& cloud,
                                                         const ScanView& view) {
    constexpr unsigned kMostRounds = 10, kPatience = 2;
    std::optional<ScanOnCourse> best;
    for (unsigned round = 0, worse = 0; round < kMostRounds && worse < kPatience; ++round) {
        const Course course = round == 0 ? evenCourse(known, cloud) : courseOf(known, cloud, view);
        undistortFirst(course.seenFrom(-known.since_s));
        auto next = registerOn(course, known, map_, cloud, view, options_);
        if (!next) break;
        known.pose = next->estimate.pose();
        const bool better = !best || next->share > best->share;
        worse = better ? 0 : worse + 1;
        if (better) best = std::move(next);
    }
    if (best) undistortFirst(best->course.seenFrom(-known.since_s));
    return best;
}

/** De-skews the scan by the motion that was found and registers it again: by an uneven motion, or
 *  by an even one where clearly fewer points fit then. Where that does not fit either, the scan
 *  stays de-skewed by the prediction. `inlierRatio`: that of the scan as it is. */
void PlaneOdometry::undistortAgain(const scan::PointCloud& cloud, double since_s,
                                   double inlierRatio, ScanView& view, PlaneEstimate& estimate) {
    constexpr double kNoise = 0.02;  // of an inlier ratio
    const KnownMotion known{reference_.pose, since_s, estimate.pose()};
    const auto fits = [&](const std::optional<ScanOnCourse>& found) {
        return found && found->share >= inlierRatio - kNoise;
    };
    std::optional<ScanOnCourse> found;
    if (skewed_)
        found = undistortPair(known, cloud, view);
    else
        for (const bool even : {false, true}) {
            found = registerOn(even ? evenCourse(known, cloud) : courseOf(known, cloud, view),
                               known, map_, cloud, view, options_);
            if (fits(found)) break;
        }
    const bool isFirst = std::exchange(skewed_, {}).has_value();
    if (!found || (!isFirst && !fits(found))) return;
    estimate = found->estimate;
    view = std::move(found->view);
    onward_ = Onward(found->course.seenFrom(0), since_s / 8);
}

/** What the next scans are judged by. */
void PlaneOdometry::learn(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                          double since_s) {
    if (prediction_.hasMotion()) {
        // A scan that fits badly where it was not expected may be at a wrong pose.
        constexpr double kForget = 0.1, kAsUsual = 0.75;
        const auto& points = options_.points;
        const bool isDoubtful = placed.share < kAsUsual * usualShare_ &&
                                points::stepBetween(predicted, placed.pose).norm() >
                                    kernel_.width(points.least_kernel, points.first_kernel);
        if (!isDoubtful)
            usualShare_ = usualShare_ == 0 ? placed.share
                                           : (1 - kForget) * usualShare_ + kForget * placed.share;
        kernel_.observe(pose_, predicted);
        unevenness_.observe(reference_.pose.inverse() * pose_, prediction_.predict(since_s));
    }
    prediction_.observe(reference_.pose.inverse() * pose_, since_s);
}

void PlaneOdometry::insert(const ScanView& view, const Eigen::Isometry3d& pose) {
    map_.add(view.fine, pose);
    reference_ = {view.points, pose, arrivals_.sinceStart_s()};
}

/** At pose_, while the next scan is thinned. */
void PlaneOdometry::insertLater(ScanView& view) {
    reference_ = {view.points, pose_, arrivals_.sinceStart_s()};
    skewed_.reset();  // the map no longer holds the first scan alone
    awaited_ = PlacedPoints{std::move(view.fine), pose_};
}

/** Puts into the map what waits for it. */
void PlaneOdometry::settle() {
    if (awaited_) map_.add(awaited_->points, awaited_->pose);
    awaited_.reset();
}

/** A new map of this scan, at pose_. */
ScanView PlaneOdometry::beginMap(const scan::PointCloud& cloud) {
    // The first pair has one scan only to be registered against: it is taken as dense as it came.
    constexpr double kDense = 0.2;
    ScanView view = undistorted(cloud, Motion{});
    thin(view, kDense * options_.tracker.map_spacing, options_.tracker.scan_spacing);
    map_.clear(upAt(pose_));
    awaited_.reset();
    dynamics_.clear();
    usualShare_ = 0;
    insert(view, pose_);
    skewed_.reset();
    if (!cloud.times_s.empty()) skewed_ = cloud;
    started_ = map_.isUsable();
    return view;
}

/** Nothing to register it against. */
void PlaneOdometry::processFirstOfMap(const scan::PointCloud& cloud, Step& step) {
    ScanView view = timed(timeOf(step, "map_update"), [&] { return beginMap(cloud); });
    // What was driven since scans that could not be used is not known.
    if (!first_) step.reason = "no usable scan before it";
    if (!started_) step.reason = cloud.points.cols() == 0 ? "no points" : "too few points";
    first_ = false;
    step.details = detailsOf({}, {});
    report(planes::predictedEstimate(pose_, options_.registration, errorGrowth(unregistered_s_)),
           pose_, view, step);
}

/** From the latest scan on, of which it is not asked twice. */
Onward PlaneOdometry::onwardMotion(double duration_s) {
    Onward onward(prediction_.predict(duration_s), duration_s);
    if (onward_ && !lost_ && !doubted_) onward = *onward_;
    onward_.reset();
    return onward;
}

/** A scan that says nothing about the motion: its pose is the prediction, and the tracking goes on
 *  from the scan before. */
void PlaneOdometry::skip(const scan::PointCloud& cloud, const Interval& interval, Step& step) {
    const Onward onward = onwardMotion(interval.duration_s);
    const Eigen::Isometry3d before = pose_;
    pose_ = pose_ * onward.at(interval.duration_s);
    ScanView view = undistorted(cloud, onward.motion());
    step.details = detailsOf({}, {});
    report(planes::predictedEstimate(pose_, options_.registration, errorGrowth(unregistered_s_)),
           before, view, step);
}

/** Every other scan: undistort, place by points, leave out what moves, refine by planes; it comes
 *  into the map while the next one is thinned. */
void PlaneOdometry::processNext(const scan::PointCloud& cloud, const Interval& interval,
                                Step& step) {
    // Where scans were missed in between, what was driven since then was driven in all this time.
    const double since_s = arrivals_.sinceStart_s() - reference_.time_s;
    const Onward onward = onwardMotion(interval.duration_s);
    const Eigen::Isometry3d predicted = pose_ * onward.at(interval.duration_s);
    ScanView view =
        timed(timeOf(step, "undistort"), [&] { return undistorted(cloud, onward.motion()); });
    const auto voxels = timed(timeOf(step, "thinning"), [&] { return thinAll(view); });
    const bool looking = options_.dynamics.enabled && !lost_;
    movers::DynamicObjects::Sight sight;
    Placement placement;
    timed(timeOf(step, "points"), [&] {
        const auto expected =
            expectation(predicted, since_s, interval.kind != IntervalKind::kUnknown);
        tbb::parallel_invoke([&] { placement = placeScan(map_, view, expected, options_); },
                             [&] {
                                 if (looking)
                                     sight = dynamics_.see(view.fine, view.points, upright_);
                             });
    });
    const PointEstimate& placed = placement.estimate;
    step.searched = placement.searched;
    const bool detecting = looking && placed.valid;
    if (detecting)
        timed(timeOf(step, "dynamic"),
              [&] { leaveOutDynamicObjects(voxels, std::move(sight), placed.pose, view); });
    const auto estimate = timed(timeOf(step, "planes"), [&] {
        if (!placed.valid)
            return planes::predictedEstimate(predicted, options_.registration,
                                             errorGrowth(unregistered_s_));
        view.thinned =
            scan::voxelCentroids(view.fine, options_.tracker.scan_spacing).cast<double>();
        auto found = map_.refine(view, placed, predicted, reference_.pose);
        if (step.deskewed) undistortAgain(cloud, since_s, placed.share, view, found);
        return found;
    });
    const Eigen::Isometry3d before = pose_;
    pose_ = estimate.valid ? estimate.pose() : predicted;
    lost_ = !estimate.valid || step.interrupted;  // how fast it goes is not known
    timed(timeOf(step, "map_update"), [&] {
        if (!estimate.valid) return giveUp(cloud);
        misses_ = 0;
        // What is only believed must not become the map that the next scan confirms it by.
        doubted_ = estimate.translation.unobservedAxes.cols() > 0;
        const double moved_m = (pose_.translation() - reference_.pose.translation()).norm();
        if (doubted_ && moved_m <= options_.tracker.doubt_spacing) return;
        if (!step.interrupted) learn(placed, predicted, since_s);
        if (detecting) dynamics_.remember(pose_ * turnedBack(upright_));
        insertLater(view);
    });
    if (!estimate.valid)
        step.reason = cloud.points.cols() == 0 ? "no points" : "not found in the map";
    step.details = detailsOf(estimate, placed);
    report(estimate, before, view, step);
}

/** Scans in a row that are not found in the map: sooner or later a new one is begun. */
void PlaneOdometry::giveUp(const scan::PointCloud& cloud) {
    constexpr unsigned kPatience = 3;
    if (cloud.points.cols() > 0) ++misses_;
    if (misses_ < kPatience) return;
    misses_ = 0;
    takeScale(seenScale_);  // the map may have begun with the vehicle's own body
    beginMap(cloud);
}

/** What became of the scan, of which pose_ is the pose and `before` that of the one before. */
void PlaneOdometry::report(const PlaneEstimate& estimate, const Eigen::Isometry3d& before,
                           ScanView& view, Step& step) const {
    const auto dynamic = std::count(view.dynamic.begin(), view.dynamic.end(), std::uint8_t{1});
    step.increment = incrementOf(estimate.rotation, estimate.translation);
    step.increment.pose = normalised(before.inverse() * pose_);
    step.quality = qualityOf(estimate.rotation, estimate.translation);
    step.predicted = !step.reason.empty();
    const auto points = std::max<double>(1, static_cast<double>(view.dynamic.size()));
    step.details.emplace_back("dynamic", static_cast<double>(dynamic));
    step.details.emplace_back("dynamic_share", static_cast<double>(dynamic) / points);
    step.used.points = std::move(view.points);
    step.used.dynamic = std::move(view.dynamic);
}

Step PlaneOdometry::process(const Scan& scan) {
    requireConsistent(scan);
    Step step;
    step.times_ms = noTimes();
    const Arrival arrival = arrivals_.take(scan);
    const Interval& interval = arrival.interval;
    unregistered_s_ += interval.elapsed_s;
    seenScale_ = given_.tracker.scale > 0 ? given_.tracker.scale : scaleOf(scan);
    if (!started_) takeScale(seenScale_);
    auto cloud = timed(timeOf(step, "preprocess"), [&] {
        auto points = scan::preprocess(scan, options_.scan);
        if (!started_) upright_ = scan::uprightOf(scan.sensorPose, points.points);
        return points;
    });
    step.notFinite = cloud.notFinite;
    step.deskewed = !cloud.times_s.empty();
    if (started_) {
        step.interrupted = interval.kind == IntervalKind::kUnknown;
        if (step.interrupted) prediction_.forget();  // whether it went on meanwhile is not known
        lost_ = lost_ || step.interrupted;
        step.reason = reasonToSkip(arrival, prediction_);
        if (step.reason.empty())
            processNext(cloud, interval, step);
        else
            skip(cloud, interval, step);
    } else
        processFirstOfMap(cloud, step);
    step.standing = isStanding(step, interval.duration_s);
    if (!step.predicted) unregistered_s_ = 0;
    if (started_ && !lost_ && isOtherScale()) {
        takeScale(seenScale_);
        beginMap(cloud);
    }
    step.details.emplace_back("scale", scale_);
    step.used.indices = std::move(cloud.indices);
    return step;
}
}  // namespace delio
