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
    if (modelErrors_m_.size() < kEnough) return registrationOptions_.first_kernel;
    double squares = 0;
    for (const double error : modelErrors_m_) squares += error * error;
    const double sigma = std::sqrt(squares / static_cast<double>(modelErrors_m_.size()));
    return std::clamp(3 * sigma, 2 * registrationOptions_.last_kernel,
                      registrationOptions_.first_kernel);
}

rotation::SurfaceNormals PlaneTracker::surfacesOf(const Eigen::Matrix3Xf& points) const {
    return rotation::filterBilaterally(rotation::estimateNormals(points, normalsOptions_),
                                       bilateralOptions_);
}

PlaneEstimate PlaneTracker::search(const rotation::SurfaceNormals& surfaces,
                                   const Eigen::Matrix3Xd& points, const CPose3D& guess,
                                   double duration_s) const {
    // Rotation first, by the paper's way, which no translation can disturb: the pattern of this
    // scan's normals on that of the latest one's.
    const Eigen::Matrix3d R = rotationOf(latestPose_);
    const auto pattern = rotation::registerPatterns(
        rotation::patternOf(surfacesOf(latest_)), rotation::patternOf(surfaces),
        R.transpose() * rotationOf(guess), patternOptions_);
    return searchInPlanes(map_, points, surfaces, R * pattern.rotation, translationOf(guess),
                          std::min(registrationOptions_.search_speed * duration_s,
                                   registrationOptions_.search_radius),
                          registrationOptions_);
}

PlaneEstimate PlaneTracker::place(const Eigen::Matrix3Xf& all, const Eigen::Matrix3Xd& points,
                                  double duration_s) const {
    const CPose3D guess = pose_ + prediction_.predict(duration_s);
    if (lost_) return search(surfacesOf(all), points, guess, duration_s);
    const auto found = registerToPlanes(map_, points, rotationOf(guess), translationOf(guess),
                                        kernel(), registrationOptions_);
    if (found.valid && found.share >= options_.lost_share * usualShare_) return found;
    const auto surfaces = surfacesOf(all);
    const auto searched = search(surfaces, points, guess, duration_s);
    const auto agreed = [&](const PlaneEstimate& estimate) {
        return agreement(map_, surfaces, estimate.rotation.rotation,
                         estimate.translation.translation, 2 * registrationOptions_.last_kernel);
    };
    return agreed(searched) > agreed(found) ? searched : found;
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

Tracked PlaneTracker::track(const Eigen::Matrix3Xf& points, double stamp_s) {
    mrpt::system::CTicTac clock;
    Tracked result;
    const Eigen::Matrix3Xf fine = scan::voxelCentroids(points, options_.map_spacing);
    const Eigen::Matrix3Xd thinned =
        scan::voxelCentroids(fine, options_.scan_spacing).cast<double>();
    if (started_) {
        const double elapsed = stamp_s - stamp_s_;
        const double duration_s = elapsed > 0 ? elapsed : 0.1;
        const CPose3D guess = pose_ + prediction_.predict(duration_s);
        result.estimate = place(points, thinned, duration_s);
        result.predicted = !result.estimate.valid;
        if (result.predicted) result.reason = points.cols() == 0 ? "no points" : "too few planes";
        const CPose3D pose = result.predicted ? guess
                                              : CPose3D(result.estimate.rotation.rotation,
                                                        result.estimate.translation.translation);
        if (!result.predicted && prediction_.hasMotion()) learn(pose, guess, result.estimate);
        if (!result.predicted || prediction_.hasMotion())
            prediction_.observe(pose - pose_, duration_s);
        pose_ = pose;
        lost_ = result.predicted;
        constexpr unsigned kPatience = 3;
        if (!result.predicted)
            misses_ = 0;
        else if (points.cols() > 0 && ++misses_ == kPatience) {
            misses_ = 0;
            map_.clear();
            started_ = false;
        }
    } else {
        result.estimate =
            predictedEstimate(rotationOf(pose_), translationOf(pose_), registrationOptions_);
        // What was driven since scans that could not be used is not known.
        result.predicted = !first_;
        if (!first_) result.reason = "no usable scan before it";
    }
    first_ = false;
    result.register_ms = 1e3 * clock.Tac();
    clock.Tic();
    if (!started_ || !result.predicted) {
        const Eigen::Matrix3Xd placed =
            (rotationOf(pose_) * fine.cast<double>()).colwise() + translationOf(pose_);
        map_.add(placed);
        map_.forgetFarFrom(translationOf(pose_));
        latest_ = points;
        latestPose_ = pose_;
    }
    if (!started_) {
        started_ = map_.planes() > 0;
        if (!started_) {
            result.predicted = true;
            result.reason = points.cols() == 0 ? "no points" : "no surfaces";
        }
    }
    stamp_s_ = stamp_s;
    result.pose = pose_;
    result.map_ms = 1e3 * clock.Tac();
    return result;
}
}  // namespace delio::localmap
