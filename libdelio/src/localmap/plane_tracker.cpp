#include "delio/localmap/plane_tracker.h"

#include <mrpt/system/CTicTac.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "delio/scan/voxel_grid.h"

namespace delio::localmap {
using mrpt::poses::CPose3D;

namespace {
Eigen::Matrix3d rotationOf(const CPose3D& pose) { return pose.getRotationMatrix().asEigen(); }
Eigen::Vector3d translationOf(const CPose3D& pose) { return {pose.x(), pose.y(), pose.z()}; }
CPose3D poseOf(const PlaneEstimate& estimate) {
    return {estimate.rotation.rotation, estimate.translation.translation};
}

/** The points that are not marked. */
Eigen::Matrix3Xf unmarked(const Eigen::Matrix3Xf& points, const std::vector<std::uint8_t>& marks) {
    Eigen::Matrix3Xf result(3, points.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (!marks[static_cast<std::size_t>(i)]) result.col(kept++) = points.col(i);
    result.conservativeResize(3, kept);
    return result;
}
}  // namespace

std::vector<OptionField> PlaneTrackerOptions::fields() {
    return {
        {"enabled", &enabled,
         "true: scans are registered against a map of planes; false: against the last scan"},
        {"map_spacing", &map_spacing, "m; points of a scan that go into the map are so far apart",
         0.01, 10},
        {"scan_spacing", &scan_spacing, "m; points that are registered are so far apart", 0.01, 10},
        {"lost_share", &lost_share,
         "share of the usual share of points on their planes; with less a scan is searched for", 0,
         1}};
}

/** Three standard deviations of what the motion model was off lately, within the options. */
double PlaneTracker::kernel() const {
    constexpr std::size_t kEnough = 3;
    if (modelErrors_m_.size() < kEnough) return options_.registration.first_kernel;
    double squares = 0;
    for (const double error : modelErrors_m_) squares += error * error;
    const double sigma = std::sqrt(squares / static_cast<double>(modelErrors_m_.size()));
    return std::clamp(3 * sigma, 2 * options_.registration.last_kernel,
                      options_.registration.first_kernel);
}

rotation::SurfaceNormals PlaneTracker::surfacesOf(const Eigen::Matrix3Xf& points) const {
    return rotation::filterBilaterally(rotation::estimateNormals(points, options_.normals),
                                       options_.bilateral);
}

PlaneEstimate PlaneTracker::search(const rotation::SurfaceNormals& surfaces,
                                   const Eigen::Matrix3Xd& points, const CPose3D& guess,
                                   double duration_s) const {
    // Rotation first, by the paper's way, which no translation can disturb: the pattern of this
    // scan's normals on that of the latest one's.
    const Eigen::Matrix3d R = rotationOf(latestPose_);
    const auto pattern = rotation::registerPatterns(
        rotation::patternOf(surfacesOf(latest_)), rotation::patternOf(surfaces),
        R.transpose() * rotationOf(guess), options_.pattern);
    return searchInPlanes(map_, points, surfaces, R * pattern.rotation, translationOf(guess),
                          std::min(options_.registration.search_speed * duration_s,
                                   options_.registration.search_radius),
                          options_.registration);
}

PlaneTracker::View PlaneTracker::viewOf(const scan::PointCloud& cloud, const Motion& motion) const {
    View view;
    view.points =
        cloud.times_s.empty() ? cloud.points : scan::deskew(cloud.points, cloud.times_s, motion);
    view.moving.resize(static_cast<std::size_t>(view.points.cols()));
    return view;
}

/** Thins the points for map and registration. */
void PlaneTracker::thin(View& view) const {
    view.fine =
        scan::voxelCentroids(unmarked(view.points, view.moving), options_.tracker.map_spacing);
    view.thinned = scan::voxelCentroids(view.fine, options_.tracker.scan_spacing).cast<double>();
}

/** The same where what moves is not known yet. */
void PlaneTracker::thinWithoutWhatMoves(View& view, const CPose3D& pose) {
    const auto voxels = scan::numberVoxels(view.points, options_.tracker.map_spacing);
    const auto centroids = scan::centroidsOf(view.points, voxels);
    const auto moving = movingObjects_.find(centroids, view.points, pose, time_s_);
    for (std::size_t i = 0; i < view.moving.size(); ++i)
        view.moving[i] = moving[static_cast<std::size_t>(voxels.ofPoint[i])];
    view.fine = unmarked(centroids, moving);
    view.thinned = scan::voxelCentroids(view.fine, options_.tracker.scan_spacing).cast<double>();
}

PlaneEstimate PlaneTracker::place(const View& view, const CPose3D& guess, double duration_s) const {
    if (lost_) return search(surfacesOf(view.points), view.thinned, guess, duration_s);
    const auto found = registerToPlanes(map_, view.thinned, rotationOf(guess), translationOf(guess),
                                        kernel(), options_.registration);
    if (found.valid && found.share >= options_.tracker.lost_share * usualShare_) return found;
    const auto surfaces = surfacesOf(view.points);
    const auto searched = search(surfaces, view.thinned, guess, duration_s);
    const auto agreed = [&](const PlaneEstimate& estimate) {
        return agreement(map_, surfaces, estimate.rotation.rotation,
                         estimate.translation.translation, 2 * options_.registration.last_kernel);
    };
    return agreed(searched) > agreed(found) ? searched : found;
}

/** Once more, with the points where the motion that was found puts them. (It is the mean since the
 *  latest scan that was placed. Extrapolated to this one it did worse: vehicles shake.) */
void PlaneTracker::refine(const scan::PointCloud& cloud, double since_s, View& view,
                          PlaneEstimate& estimate) {
    const auto motion = Motion::of(poseOf(estimate) - latestPose_, since_s);
    if (skewed_) {
        map_.clear();
        View first = viewOf(*skewed_, motion);
        thin(first);
        insert(first, latestPose_);
        skewed_.reset();
    }
    View again = viewOf(cloud, motion);
    again.moving = view.moving;
    thin(again);
    const auto better = registerToPlanes(
        map_, again.thinned, estimate.rotation.rotation, estimate.translation.translation,
        2 * options_.registration.last_kernel, options_.registration);
    if (!better.valid) return;
    view = std::move(again);
    estimate = better;
}

void PlaneTracker::learn(const CPose3D& pose, const CPose3D& guess, const PlaneEstimate& estimate) {
    // An error of the rotation moves points at this distance by as much (Vizzo et al., KISS-ICP).
    constexpr double kTypicalRange_m = 20;
    constexpr std::size_t kMemory = 20;
    const CPose3D off = pose - guess;
    const double angle = Eigen::AngleAxisd(rotationOf(off)).angle();
    modelErrors_m_.push_back(translationOf(off).norm() +
                             2 * kTypicalRange_m * std::sin(std::abs(angle) / 2));
    if (modelErrors_m_.size() > kMemory) modelErrors_m_.pop_front();
    constexpr double kForget = 0.1;
    usualShare_ =
        usualShare_ == 0 ? estimate.share : (1 - kForget) * usualShare_ + kForget * estimate.share;
}

void PlaneTracker::insert(const View& view, const CPose3D& pose) {
    map_.add((rotationOf(pose) * view.fine.cast<double>()).colwise() + translationOf(pose));
    map_.forgetFarFrom(translationOf(pose));
    latest_ = view.points;
    latestPose_ = pose;
    latestTime_s_ = time_s_;
}

/** The first scan of a map. */
void PlaneTracker::begin(const scan::PointCloud& cloud, Tracked& result) {
    View view = viewOf(cloud, {});
    thin(view);
    map_.clear();
    movingObjects_.clear();
    insert(view, pose_);
    skewed_.reset();
    if (!cloud.times_s.empty()) skewed_ = cloud;
    started_ = map_.planes() > 0;
    result.estimate =
        predictedEstimate(rotationOf(pose_), translationOf(pose_), options_.registration);
    // What was driven since scans that could not be used is not known.
    if (!first_) result.reason = "no usable scan before it";
    if (!started_) result.reason = cloud.points.cols() == 0 ? "no points" : "no surfaces";
    result.points = std::move(view.points);
    result.moving = std::move(view.moving);
}

/** Every other scan. */
void PlaneTracker::follow(const scan::PointCloud& cloud, double duration_s, Tracked& result) {
    mrpt::system::CTicTac clock;
    // Where scans were missed in between, what was driven since then was driven in all this time.
    const double since_s = time_s_ - latestTime_s_;
    const CPose3D step = prediction_.predict(duration_s), guess = pose_ + step;
    View view = viewOf(cloud, Motion::of(step, duration_s));
    if (options_.moving.enabled && !lost_)
        thinWithoutWhatMoves(view, guess);
    else
        thin(view);
    result.moving_ms = 1e3 * clock.Tac();
    clock.Tic();
    result.estimate = place(view, guess, since_s);
    if (result.estimate.valid && !cloud.times_s.empty())
        refine(cloud, since_s, view, result.estimate);
    const bool found = result.estimate.valid;
    if (!found) result.reason = cloud.points.cols() == 0 ? "no points" : "too few planes";
    const CPose3D pose = found ? poseOf(result.estimate) : guess;
    if (found && prediction_.hasMotion()) learn(pose, guess, result.estimate);
    if (found) prediction_.observe(pose - latestPose_, since_s);
    pose_ = pose;
    result.register_ms = 1e3 * clock.Tac();
    clock.Tic();
    if (found) {
        if (options_.moving.enabled && !lost_) movingObjects_.remember(pose);
        insert(view, pose);
        misses_ = 0;
    } else if (cloud.points.cols() > 0)
        ++misses_;
    lost_ = !found;
    result.points = std::move(view.points);
    result.moving = std::move(view.moving);
    result.map_ms = 1e3 * clock.Tac();
}

Tracked PlaneTracker::track(const scan::PointCloud& cloud, double stamp_s) {
    Tracked result;
    constexpr double kUsual_s = 0.1;  // where stamps do not rise
    const double elapsed = stamp_s - stamp_s_;
    const double duration_s = elapsed > 0 ? elapsed : kUsual_s;
    if (!first_) time_s_ += duration_s;
    if (started_)
        follow(cloud, duration_s, result);
    else
        begin(cloud, result);
    constexpr unsigned kPatience = 3;
    if (misses_ == kPatience) {
        misses_ = 0;
        Tracked ofNewMap;
        begin(cloud, ofNewMap);
    }
    first_ = false;
    stamp_s_ = stamp_s;
    result.predicted = !result.reason.empty();
    result.pose = pose_;
    return result;
}
}  // namespace delio::localmap
