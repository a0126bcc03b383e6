#include "odometry/paper_odometry.h"
#include "odometry/reporting.h"

#include <algorithm>
#include <cmath>

#include "core/scan_trajectory.h"
#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "odometry/deskew.h"
#include "odometry/search_points.h"
#include "odometry/spin_axis.h"
#include "paper/line_registration.h"

namespace delio::odometry {

CheckPoints checkPointsOf(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                          const PointCheckOptions& options, const PointMapOptions& map) {
    CheckPoints check{{}, PointMap(map), upright};
    const Eigen::Matrix3Xf fine = voxelCentroids(points, options.map_spacing);
    check.map.add(fine.cast<double>());
    check.points = firstOfVoxels(fine, options.point_spacing).cast<double>();
    return check;
}

PointEstimate checkByPoints(const CheckPoints& from, const CheckPoints& to,
                            const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted,
                            double reach, const PointCheckOptions& options,
                            const PointRegistrationOptions& registration) {
    const auto& points = to.points;
    Eigen::Isometry3d rest = predicted;  // a rotation that was found may be off by much
    rest.translation().setZero();
    const auto moved = pointsOff(from.map, points, rest, options.rest);
    const auto shareOf = [&](const Eigen::Isometry3d& pose) {
        return shareAt(from.map, moved, pose, registration.last_kernel);
    };
    PointEstimate best;
    double most = 0;
    const auto compare = [&](const PointEstimate& placed) {
        const double share = placed.valid ? shareOf(placed.pose) : 0;
        if (share <= most) return;
        most = share;
        best = placed;
    };
    const double kernel = registration.least_kernel;
    compare(registerToPoints(from.map, points, found, kernel, registration));
    if (most < options.min_share || !agree(best.pose, found, options)) {
        compare(registerToPoints(from.map, points, predicted, kernel, registration));
        compare(searchPoints(from.map, points, rest, {reach, 0}, to.upright, registration));
    }
    const auto least = options.min_moved * static_cast<double>(points.cols());
    best.valid = static_cast<double>(moved.cols()) >= least && most >= options.min_share &&
                 most > shareOf(found);
    return best;
}

bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
           const PointCheckOptions& options) {
    return (a.translation() - b.translation()).norm() <= options.believed &&
           angleOf(a.linear().transpose() * b.linear()) <= options.believed_deg * M_PI / 180;
}

namespace {
constexpr double kDeg = M_PI / 180;

/** Runs a stage and adds its time. */
template <typename Work>
auto stage(const char* name, Step& step, const Work& work) {
    const StageTimer timer(step, name);
    return work();
}

/** The registration's own times and figures. */
void note(const PaperRegistration& found, Step& step) {
    step.times_ms.emplace_back("rotation", found.rotation_ms);
    step.times_ms.emplace_back("translation", found.translation_ms);
    step.times_ms.emplace_back("check", found.check_ms);
    const auto put = [&](const char* name, double value) {
        step.details.emplace_back(name, value);
    };
    put("overlap", found.translation.overlap);
    put("rotation_iterations", found.rotation.iterations);
    put("rotation_converged", found.rotation.converged);
    put("translation_iterations", found.translation.iterations);
    put("translation_converged", found.translation.converged);
    put("denied", found.denied);
}

/** Rotation and translation again, now that it is known which normals were found at one place. */
void refineInPlace(const PaperFeatures& from, const PaperFeatures& to, paper::LineMatcher& matcher,
                   const PaperOdometryOptions& options, PaperRegistration& found) {
    for (unsigned round = 0; round < options.inPlace.rounds; ++round) {
        if (!found.rotation.valid || !found.translation.valid) return;
        const Eigen::Vector3d t = found.translation.translation;
        found.rotation = timed(found.rotation_ms, [&] {
            return paper::registerInPlace(from.pattern, to.pattern, found.rotation, t,
                                          options.inPlace);
        });
        found.translation = timed(found.translation_ms, [&] {
            return paper::registerLines(matcher, paper::rotated(to.lines, found.rotation.rotation),
                                        t, options.lineRegistration);
        });
    }
}

PaperRegistration byPatternAndLines(const PaperFeatures& from, const PaperFeatures& to,
                                    const Eigen::Isometry3d& guess, double search_m,
                                    const PaperOdometryOptions& options) {
    PaperRegistration result;
    result.rotation = timed(result.rotation_ms, [&] {
        return paper::registerPatterns(from.pattern, to.pattern, guess.linear(), options.pattern);
    });
    std::optional<paper::LineMatcher> matcher;
    result.translation = timed(result.translation_ms, [&] {
        const auto unrotated = paper::rotated(to.lines, result.rotation.rotation);
        matcher.emplace(from.lines);
        return paper::searchTranslation(*matcher, unrotated, guess.translation(), search_m,
                                        options.lineRegistration);
    });
    refineInPlace(from, to, *matcher, options, result);
    if (!result.rotation.valid)
        result.predictedReason = result.rotation.tooFar ? "no rotation found" : "too few normals";
    if (!result.translation.valid)
        result.predictedReason += result.rotation.valid ? "too few lines" : " and too few lines";
    return result;
}

Eigen::Isometry3d poseOf(const PaperRegistration& found) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = found.rotation.rotation;
    pose.translation() = found.translation.translation;
    return pose;
}

void nameAxis(const Eigen::Vector3d& axis, double sigma, Eigen::Matrix3Xd& axes,
              Eigen::Matrix3d& covariance) {
    axes.conservativeResize(3, axes.cols() + 1);
    axes.rightCols<1>() = axis;
    covariance += sigma * sigma * axis * axis.transpose();
}

/** Where rotation or translation lead away from `placed` they do not know better: these axes stay
 *  as points have them. */
void hold(const Eigen::Isometry3d& placed, const PaperOdometryOptions& options,
          PaperRegistration& found) {
    auto& rotation = found.rotation;
    auto& translation = found.translation;
    const Eigen::Vector3d turned = rotationLog(placed.linear().transpose() * rotation.rotation);
    if (turned.norm() > options.check.believed_deg * kDeg) {
        rotation.rotation = placed.linear();
        nameAxis(turned.normalized(), options.pattern.prior_sigma_deg * kDeg,
                 rotation.unobservedAxes, rotation.covariance);
    }
    const Eigen::Vector3d off = translation.translation - placed.translation();
    if (off.norm() > options.check.believed) {
        translation.translation = placed.translation();
        nameAxis(off.normalized(), options.lineRegistration.prior_sigma, translation.unobservedAxes,
                 translation.covariance);
    }
}

/** Both as one, whose errors grow with the distance: from another place other parts of the surfaces
 *  are seen, whose normals differ a little. */
Increment incrementOf(const PaperRegistration& found, const PaperOdometryOptions& options) {
    auto rotation = found.rotation;
    const double growth = 1 + found.translation.translation.norm() / options.pattern.view_distance;
    rotation.covariance *= growth * growth;
    return incrementOf(rotation, found.translation);
}
}  // namespace

std::optional<Link> PaperFeatures::linkTo(const ScanFeatures& earlier,
                                          const Eigen::Isometry3d& guess) const {
    const auto& from = dynamic_cast<const PaperFeatures&>(earlier);
    const auto found = byPatternAndLines(from, *this, guess, 0, *options);
    if (!found.predictedReason.empty()) return {};
    if (check && from.check) {
        // Where it stands is known already: nothing is searched. Seen from afar, surfaces differ.
        PointCheckOptions wider = options->check;
        wider.believed *= 2;
        wider.believed_deg *= 2;
        const auto placed =
            checkByPoints(*from.check, *check, poseOf(found), guess, 0, wider, options->points);
        if (placed.valid && !agree(placed.pose, poseOf(found), wider)) return {};
    }
    return Link{incrementOf(found, *options), found.translation.overlap};
}

PaperRegistration registerFeatures(const PaperFeatures& from, const PaperFeatures& to,
                                   const Eigen::Isometry3d& guess, double search_m,
                                   const PaperOdometryOptions& options) {
    auto found = byPatternAndLines(from, to, guess, search_m, options);
    if (found.predictedReason.empty() && from.check && to.check) {
        const double reach = std::max(options.check.reach, 1.5 * guess.translation().norm());
        const auto placed = timed(found.check_ms, [&] {
            return checkByPoints(*from.check, *to.check, poseOf(found), guess, reach, options.check,
                                 options.points);
        });
        if (placed.valid && !agree(placed.pose, poseOf(found), options.check)) {
            const double check_ms = found.check_ms;
            found = byPatternAndLines(from, to, placed.pose, 0, options);
            hold(placed.pose, options, found);
            found.check_ms = check_ms;
            found.denied = true;
        }
    }
    found.increment = incrementOf(found, options);
    return found;
}

PaperOdometry::PaperOdometry(const PaperOdometryOptions& options)
    : options_(std::make_shared<PaperOdometryOptions>(options)),
      arrivals_(needsTimes(options.scan)),
      prediction_(options.prediction) {}

/** The paper's rings and sectors are about z. */
Eigen::Matrix3f PaperOdometry::upright() const {
    return upright_.value_or(Eigen::Matrix3f::Identity());
}

/** Section III and IV-A: the pattern of the normals, and the lines. */
std::shared_ptr<const PaperFeatures> PaperOdometry::extract(const PointCloud& cloud,
                                                            Step& step) const {
    auto features = std::make_shared<PaperFeatures>();
    features->options = options_;
    const auto raw = stage("normals", step,
                           [&] { return paper::estimateNormals(cloud.points, options_->normals); });
    const auto normals = stage("bilateral", step,
                               [&] { return paper::filterBilaterally(raw, options_->bilateral); });
    features->pattern =
        stage("outliers", step, [&] { return paper::removeOutliers(normals, options_->outliers); });
    std::size_t modes = 0;  // 0 where they are not needed
    features->pattern = stage("mean_shift", step, [&] {
        if (!paper::needsModes(features->pattern, options_->meanShift)) return features->pattern;
        const auto found = paper::seekModes(normals.directions, options_->meanShift);
        modes = found.size();
        return paper::patternOfModes(normals, found, options_->meanShift, options_->outliers);
    });
    // Another draw for every scan: of two scans made from nearly one place, the same draw gives
    // nearly the same lines, each of which then pairs with itself and holds the vehicle at rest.
    auto lineOptions = options_->lines;
    lineOptions.seed += scans_;
    features->lines = stage("lines", step, [&] {
        const auto drawn = paper::drawLines(upright() * cloud.points, cloud.rings, lineOptions);
        return paper::rotated(drawn, upright().transpose().cast<double>());
    });
    stage("check_points", step, [&] {
        if (options_->check.enabled)
            features->check =
                checkPointsOf(cloud.points, upright(), options_->check, options_->pointMap);
    });
    step.details = {{"normals", static_cast<double>(normals.directions.cols())},
                    {"pattern", static_cast<double>(features->pattern.directions.cols())},
                    {"modes", static_cast<double>(modes)},
                    {"lines", static_cast<double>(features->lines.midpoints.cols())}};
    return features;
}

/** The increment since the last scan, of a registration against the last usable one. */
void PaperOdometry::takeIncrement(const PaperRegistration& registration, double duration_s,
                                  Step& step) {
    const Eigen::Isometry3d sinceReference = registration.increment.pose;
    step.increment = registration.increment;
    step.increment.pose = normalised(sinceReference_.inverse() * sinceReference);
    if (step.predicted) step.increment.covariance *= std::pow(errorGrowth(unregistered_s_), 2);
    step.quality = qualityOf(registration.rotation, registration.translation);
    // How fast it goes is not known after an interruption.
    if (!step.interrupted && registration.predictedReason.empty())
        prediction_.observe(sinceReference, sinceReference_s_);
    else if (!step.interrupted && prediction_.hasMotion())
        prediction_.observe(step.increment.pose, duration_s);
    sinceReference_ = sinceReference_ * step.increment.pose;
    lost_ = step.predicted || step.interrupted;
}

Step PaperOdometry::process(const Scan& scan) {
    requireConsistent(scan);
    Step step;
    const Arrival arrival = arrivals_.take(scan, scan.stamp_s);
    const Interval& interval = arrival.interval;
    step.interrupted = interval.kind == IntervalKind::kUnknown;
    if (step.interrupted) prediction_.forget();  // whether it went on meanwhile is not known
    lost_ = lost_ || step.interrupted;
    sinceReference_s_ += interval.duration_s;
    unregistered_s_ += interval.elapsed_s;
    const Eigen::Isometry3d predicted = prediction_.predict(interval.duration_s);
    auto cloud = stage("preprocess", step, [&] {
        auto made = preprocess(scan, options_->scan);
        if (!upright_) upright_ = uprightOf(made.points);
        made.rings = neighbouringRings(made, upright());  // before points move
        step.deskewed = !made.times_s.empty();
        if (step.deskewed)
            made.points =
                deskew(made.points, made.times_s, Twist::of(predicted, interval.duration_s));
        return made;
    });
    const std::string skipped = reference_ ? reasonToSkip(arrival, prediction_) : "";
    const auto features = extract(skipped.empty() ? cloud : PointCloud{}, step);
    ++scans_;
    const bool usable =
        features->pattern.directions.cols() > 0 && features->lines.midpoints.cols() > 0;
    PaperRegistration registration;
    if (reference_) {
        const auto& lines = options_->lineRegistration;
        const double search_m =
            lost_ ? std::min(lines.search_speed * sinceReference_s_, lines.search_radius) : 0;
        step.searched = search_m > 0;
        registration = registerFeatures(*reference_, *features, sinceReference_ * predicted,
                                        search_m, *options_);
        step.reason = registration.predictedReason;
        step.searched = step.searched || registration.denied;
    } else if (scans_ > 1)
        step.reason = "no usable scan before it";  // what was driven since then is not known
    if (!usable) step.reason = cloud.points.cols() == 0 ? "no points" : "no surfaces";
    if (!skipped.empty()) step.reason = skipped;
    step.predicted = !step.reason.empty();
    note(registration, step);
    const bool wasLost = lost_;
    if (reference_)
        takeIncrement(registration, interval.duration_s, step);
    else  // nothing was measured
        step.quality.unobservedRotation = step.quality.unobservedTranslation =
            Eigen::Matrix3d::Identity();
    if (!skipped.empty()) lost_ = wasLost;
    if (!step.predicted) unregistered_s_ = 0;
    if (usable) {
        reference_ = features;
        sinceReference_ = Eigen::Isometry3d::Identity();
        sinceReference_s_ = 0;
    }
    step.features = features;
    step.notFinite = cloud.notFinite;
    step.used = {std::move(cloud.points), std::move(cloud.indices), {}};
    return step;
}
}  // namespace delio::odometry
