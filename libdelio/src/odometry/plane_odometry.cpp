#include "delio/odometry/plane_odometry.h"

#include <algorithm>
#include <string_view>

#include "delio/core/stopwatch.h"
#include "delio/odometry/relocalisation.h"
#include "delio/scan/voxel_grid.h"
#include "delio/surfaces/surfaces.h"

namespace delio {
using planes::PlaneEstimate;

namespace {
/** What every scan's step has, whether the stage was gone through or not. */
std::vector<Named> noTimes() {
    return {{"preprocess", 0}, {"undistort", 0},    {"thinning", 0},
            {"dynamic", 0},    {"registration", 0}, {"plane_map", 0}};
}
double& timeOf(Step& step, std::string_view stage) {
    return std::find_if(step.times_ms.begin(), step.times_ms.end(),
                        [&](const Named& time) { return time.first == stage; })
        ->second;
}
}  // namespace

std::vector<OptionField> PlaneTrackerOptions::fields() const {
    using Me = PlaneTrackerOptions;
    return {{"map_spacing", &Me::map_spacing,
             "m; points of a scan that go into the map are so far apart", 0.01, 10},
            {"scan_spacing", &Me::scan_spacing, "m; points that are registered are so far apart",
             0.01, 10},
            {"lost_share", &Me::lost_share,
             "share of the usual share of points on their planes; with less a scan is searched for",
             0, 1}};
}

PlaneOdometry::PlaneOdometry(const PlaneOdometryOptions& options)
    : options_(options),
      prediction_(options.prediction),
      map_(options.map),
      dynamics_(options.dynamics, options.segments) {}

surfaces::SurfaceNormals PlaneOdometry::surfacesOf(const Eigen::Matrix3Xf& points) const {
    return surfaces::surfacesOf(points, options_.normals, options_.bilateral);
}

void PlaneOdometry::thinned(ScanView& view) const {
    thin(view, options_.tracker.map_spacing, options_.tracker.scan_spacing);
}

/** Thins the scan, and leaves out what moves at the predicted pose. */
void PlaneOdometry::detectDynamicObjects(ScanView& view, const Eigen::Isometry3d& predicted,
                                         Step& step) {
    Stopwatch watch;
    const auto voxels = scan::numberVoxels(view.points, options_.tracker.map_spacing);
    const auto centroids = scan::centroidsOf(view.points, voxels);
    timeOf(step, "thinning") += watch.lap_ms();
    const auto dynamic =
        dynamics_.detect(centroids, view.points, predicted, timeline_.sinceStart_s());
    timeOf(step, "dynamic") += watch.lap_ms();
    for (std::size_t i = 0; i < view.dynamic.size(); ++i)
        view.dynamic[i] = dynamic[static_cast<std::size_t>(voxels.ofPoint[i])];
    view.fine = unmarked(centroids, dynamic);
    view.thinned = scan::voxelCentroids(view.fine, options_.tracker.scan_spacing).cast<double>();
    timeOf(step, "thinning") += watch.lap_ms();
}

/** Registers the scan from the prediction; where that is lost, or fits worse than usual, searches
 *  for it too. */
PlaneEstimate PlaneOdometry::place(const ScanView& view, const Eigen::Isometry3d& predicted,
                                   double since_s, Step& step) const {
    const auto& registration = options_.registration;
    PlaneEstimate found;
    if (!lost_) {
        found = planes::registerToPlanes(map_, view.thinned, predicted, kernel_.width(registration),
                                         registration);
        if (found.valid && found.share >= options_.tracker.lost_share * usualShare_) return found;
    }
    step.searched = true;
    const auto surfaces = surfacesOf(view.points);
    const double radius = step.interrupted ? registration.search_radius
                                           : std::min(registration.search_speed * since_s,
                                                      registration.search_radius);
    const auto relocalised =
        relocalise(map_, surfacesOf(reference_.points), reference_.pose, view.thinned, surfaces,
                   predicted, radius, registration, options_.pattern);
    if (lost_) return relocalised;
    const auto agreed = [&](const PlaneEstimate& estimate) {
        return planes::agreement(map_, surfaces, estimate.pose(), 2 * registration.last_kernel);
    };
    return agreed(relocalised) > agreed(found) ? relocalised : found;
}

/** Once more, with the points where the motion that was found puts them. (It is the mean since the
 *  latest scan that was registered. Extrapolated to this one it did worse: vehicles shake.) */
void PlaneOdometry::refine(const scan::PointCloud& cloud, double since_s, ScanView& view,
                           PlaneEstimate& estimate) {
    const auto motion = Motion::of(reference_.pose.inverse() * estimate.pose(), since_s);
    if (skewed_) {
        ScanView first = undistorted(*skewed_, motion);
        thinned(first);
        map_.clear();
        insert(first, reference_.pose);
        skewed_.reset();
    }
    ScanView again = undistorted(cloud, motion);
    again.dynamic = view.dynamic;
    thinned(again);
    const auto better =
        planes::registerToPlanes(map_, again.thinned, estimate.pose(),
                                 2 * options_.registration.last_kernel, options_.registration);
    if (!better.valid) return;
    view = std::move(again);
    estimate = better;
}

/** What the next scans are judged by. */
void PlaneOdometry::learn(const PlaneEstimate& estimate, const Eigen::Isometry3d& predicted,
                          double since_s) {
    const Eigen::Isometry3d pose = estimate.pose();
    if (prediction_.hasMotion()) {
        constexpr double kForget = 0.1;
        kernel_.observe(pose, predicted);
        usualShare_ = usualShare_ == 0 ? estimate.share
                                       : (1 - kForget) * usualShare_ + kForget * estimate.share;
    }
    prediction_.observe(reference_.pose.inverse() * pose, since_s);
}

void PlaneOdometry::insert(const ScanView& view, const Eigen::Isometry3d& pose) {
    map_.add((pose.linear() * view.fine.cast<double>()).colwise() + pose.translation());
    map_.forgetFarFrom(pose.translation());
    reference_ = {view.points, pose, timeline_.sinceStart_s()};
}

/** A new map of this scan, at pose_. */
ScanView PlaneOdometry::beginMap(const scan::PointCloud& cloud) {
    ScanView view = undistorted(cloud, {});
    thinned(view);
    map_.clear();
    dynamics_.clear();
    insert(view, pose_);
    skewed_.reset();
    if (!cloud.times_s.empty()) skewed_ = cloud;
    started_ = map_.planes() > 0;
    return view;
}

/** Nothing to register it against. */
void PlaneOdometry::processFirstOfMap(const scan::PointCloud& cloud, Step& step) {
    ScanView view = timed(timeOf(step, "plane_map"), [&] { return beginMap(cloud); });
    // What was driven since scans that could not be used is not known.
    if (!first_) step.reason = "no usable scan before it";
    if (!started_) step.reason = cloud.points.cols() == 0 ? "no points" : "no surfaces";
    first_ = false;
    report(planes::predictedEstimate(pose_, options_.registration), pose_, view, step);
}

/** Every other scan: undistort, leave out what moves, register, insert. */
void PlaneOdometry::processNext(const scan::PointCloud& cloud, const Interval& interval,
                                Step& step) {
    step.interrupted = !interval.believed;
    if (step.interrupted) prediction_.forget();  // whether it went on meanwhile is not known
    lost_ = lost_ || step.interrupted;
    // Where scans were missed in between, what was driven since then was driven in all this time.
    const double since_s = timeline_.sinceStart_s() - reference_.time_s;
    const Eigen::Isometry3d motion = prediction_.predict(interval.duration_s),
                            predicted = pose_ * motion;
    ScanView view = timed(timeOf(step, "undistort"), [&] {
        return undistorted(cloud, Motion::of(motion, interval.duration_s));
    });
    const bool detecting = options_.dynamics.enabled && !lost_;
    if (detecting)
        detectDynamicObjects(view, predicted, step);
    else
        timed(timeOf(step, "thinning"), [&] { thinned(view); });

    PlaneEstimate estimate = timed(timeOf(step, "registration"), [&] {
        auto found = place(view, predicted, since_s, step);
        if (found.valid && step.deskewed) refine(cloud, since_s, view, found);
        return found;
    });
    const Eigen::Isometry3d before = pose_;
    pose_ = estimate.valid ? estimate.pose() : predicted;
    lost_ = !estimate.valid || step.interrupted;  // how fast it goes is not known
    timed(timeOf(step, "plane_map"), [&] {
        if (estimate.valid) {
            if (!step.interrupted) learn(estimate, predicted, since_s);
            if (detecting) dynamics_.remember(pose_);
            insert(view, pose_);
            misses_ = 0;
        } else
            giveUp(cloud);
    });
    if (!estimate.valid) step.reason = cloud.points.cols() == 0 ? "no points" : "too few planes";
    report(estimate, before, view, step);
}

/** Scans in a row that are not found in the map: sooner or later a new one is begun. */
void PlaneOdometry::giveUp(const scan::PointCloud& cloud) {
    constexpr unsigned kPatience = 3;
    if (cloud.points.cols() > 0) ++misses_;
    if (misses_ < kPatience) return;
    misses_ = 0;
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
    step.details = {{"dynamic", static_cast<double>(dynamic)},
                    {"inlier_ratio", estimate.share},
                    {"iterations", static_cast<double>(estimate.rotation.iterations)}};
    step.used.points = std::move(view.points);
    step.used.dynamic = std::move(view.dynamic);
}

Step PlaneOdometry::process(const Scan& scan) {
    Step step;
    step.times_ms = noTimes();
    const Interval interval = timeline_.advance(scan.stamp_s);
    auto cloud =
        timed(timeOf(step, "preprocess"), [&] { return scan::preprocess(scan, options_.scan); });
    step.notFinite = cloud.notFinite;
    step.deskewed = !cloud.times_s.empty();
    if (started_)
        processNext(cloud, interval, step);
    else
        processFirstOfMap(cloud, step);
    step.used.indices = std::move(cloud.indices);
    return step;
}
}  // namespace delio
