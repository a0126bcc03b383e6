#include "delio/odometry.h"

#include <mrpt/system/CTicTac.h>

#include <Eigen/Dense>
#include <algorithm>

#include "increment_of.h"

namespace delio {
using mrpt::poses::CPose3D;

namespace {
/** Runs a stage and adds its time. */
template <typename Work>
auto timed(double& ms, const Work& work) {
    mrpt::system::CTicTac clock;
    auto result = work();
    ms += 1e3 * clock.Tac();
    return result;
}

/** Orthonormal again: products of rotations lose it over thousands of scans. */
CPose3D orthonormalised(const CPose3D& pose) {
    const Eigen::Quaterniond q(Eigen::Matrix3d(pose.getRotationMatrix().asEigen()));
    return {q.normalized().toRotationMatrix(), Eigen::Vector3d(pose.x(), pose.y(), pose.z())};
}
}  // namespace

std::shared_ptr<const Features> Odometry::extract(const scan::PointCloud& cloud,
                                                  FeatureCounts& counts,
                                                  StageTimes& times_ms) const {
    auto features = std::make_shared<Features>();
    const auto raw = timed(times_ms[kNormals], [&] {
        return rotation::estimateNormals(cloud.points, options_.normals);
    });
    const auto normals = timed(
        times_ms[kBilateral], [&] { return rotation::filterBilaterally(raw, options_.bilateral); });
    features->pattern = timed(times_ms[kOutliers],
                              [&] { return rotation::removeOutliers(normals, options_.outliers); });
    if (rotation::needsModes(features->pattern, options_.meanShift))
        features->pattern = timed(times_ms[kMeanShift], [&] {
            const auto modes = rotation::seekModes(normals.directions, options_.meanShift);
            counts.modes = modes.size();
            return rotation::patternOfModes(normals, modes, options_.meanShift, options_.outliers);
        });
    // Another draw for every scan: of two scans made from nearly one place, the same draw gives
    // nearly the same lines, each of which then pairs with itself and holds the vehicle at rest.
    auto lineOptions = options_.lines;
    lineOptions.seed += scans_;
    features->lines = timed(times_ms[kLines], [&] {
        return translation::drawLines(cloud.points, cloud.rings, lineOptions);
    });
    counts.points = static_cast<std::size_t>(cloud.points.cols());
    counts.notFinite = cloud.notFinite;
    counts.normals = static_cast<std::size_t>(normals.directions.cols());
    counts.pattern = static_cast<std::size_t>(features->pattern.directions.cols());
    counts.lines = static_cast<std::size_t>(features->lines.midpoints.cols());
    return features;
}

Registration Odometry::align(const Features& from, const Features& to, const CPose3D& guess,
                             double search_m, StageTimes& times_ms) const {
    Registration result;
    result.rotation = timed(times_ms[kRotation], [&] {
        return rotation::registerPatterns(from.pattern, to.pattern,
                                          guess.getRotationMatrix().asEigen(), options_.pattern);
    });
    result.translation = timed(times_ms[kTranslation], [&] {
        const auto unrotated = translation::rotated(to.lines, result.rotation.rotation);
        const Eigen::Vector3d t(guess.x(), guess.y(), guess.z());
        return search_m > 0 ? translation::searchTranslation(from.lines, unrotated, t, search_m,
                                                             options_.lineRegistration)
                            : translation::registerLines(from.lines, unrotated, t,
                                                         options_.lineRegistration);
    });
    // From another place other parts of the surfaces are seen, whose normals differ a little.
    const double growth =
        1 + result.translation.translation.norm() / options_.pattern.view_distance;
    result.rotation.covariance *= growth * growth;
    result.increment = incrementOf(result.rotation, result.translation);
    if (!result.rotation.valid)
        result.predictedReason = result.rotation.tooFar ? "no rotation found" : "too few normals";
    if (!result.translation.valid)
        result.predictedReason += result.rotation.valid ? "too few lines" : " and too few lines";
    return result;
}

OdometryResult Odometry::process(const Scan& scan) {
    return options_.tracker.enabled ? processWithMap(scan) : processWithLastScan(scan);
}

OdometryResult Odometry::processWithMap(const Scan& scan) {
    OdometryResult result;
    auto cloud = timed(result.times_ms[kPreprocess],
                       [&] { return scan::preprocess(scan, options_.preprocess); });
    auto tracked = tracker_.track(cloud, scan.stamp_s);
    result.times_ms[kMoving] = tracked.moving_ms;
    result.times_ms[kPlanes] = tracked.register_ms;
    result.times_ms[kPlaneMap] = tracked.map_ms;
    result.counts.points = static_cast<std::size_t>(cloud.points.cols());
    result.counts.notFinite = cloud.notFinite;
    result.deskewed = !cloud.times_s.empty();
    result.counts.moving = static_cast<std::size_t>(
        std::count(tracked.moving.begin(), tracked.moving.end(), std::uint8_t{1}));
    result.used = {std::move(tracked.points), std::move(cloud.indices), std::move(tracked.moving)};
    result.registration.rotation = tracked.estimate.rotation;
    result.registration.translation = tracked.estimate.translation;
    result.increment = incrementOf(tracked.estimate.rotation, tracked.estimate.translation);
    result.increment.pose = orthonormalised(tracked.pose - tracked_);
    tracked_ = tracked.pose;
    result.predicted = tracked.predicted;
    result.reason = result.registration.predictedReason = tracked.reason;
    return result;
}

OdometryResult Odometry::processWithLastScan(const Scan& scan) {
    OdometryResult result;
    constexpr double kUsual_s = 0.1;  // where stamps do not rise
    const double elapsed = scan.stamp_s - stamp_s_;
    const double duration_s = elapsed > 0 ? elapsed : kUsual_s;
    stamp_s_ = scan.stamp_s;
    sinceReference_s_ += duration_s;
    const CPose3D step = prediction_.predict(duration_s);
    auto cloud = timed(result.times_ms[kPreprocess], [&] {
        auto made = scan::preprocess(scan, options_.preprocess);
        result.deskewed = !made.times_s.empty();
        if (result.deskewed)
            made.points = scan::deskew(made.points, made.times_s, Motion::of(step, duration_s));
        return made;
    });
    result.features = extract(cloud, result.counts, result.times_ms);
    ++scans_;
    const auto& features = *result.features;
    result.used = {std::move(cloud.points), std::move(cloud.indices), {}};
    const bool usable = result.counts.pattern > 0 && result.counts.lines > 0;
    if (reference_) {
        const auto& lines = options_.lineRegistration;
        const CPose3D guess = sinceReference_ + step;
        const double search_m =
            lost_ ? std::min(lines.search_speed * sinceReference_s_, lines.search_radius) : 0;
        result.registration = align(*reference_, features, guess, search_m, result.times_ms);
        result.reason = result.registration.predictedReason;
    } else if (scans_ > 1)
        result.reason = "no usable scan before it";  // what was driven since then is not known
    if (!usable) result.reason = result.counts.points == 0 ? "no points" : "no surfaces";
    result.predicted = !result.reason.empty();
    if (reference_) {
        result.increment = result.registration.increment;
        result.increment.pose =
            orthonormalised((-sinceReference_) + result.registration.increment.pose);
        if (result.registration.predictedReason.empty())
            prediction_.observe(result.registration.increment.pose, sinceReference_s_);
        else if (prediction_.hasMotion())
            prediction_.observe(result.increment.pose, duration_s);
        sinceReference_ = sinceReference_ + result.increment.pose;
        lost_ = result.predicted;
    }
    if (usable) {
        reference_ = result.features;
        sinceReference_ = CPose3D();
        sinceReference_s_ = 0;
    }
    return result;
}
}  // namespace delio
