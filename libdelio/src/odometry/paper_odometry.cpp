#include "odometry/paper_odometry.h"
#include "odometry/reporting.h"

#include <algorithm>
#include <cmath>

#include "core/scan_trajectory.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "odometry/deskew.h"
#include "odometry/spin_axis.h"
#include "paper/line_registration.h"

namespace delio::odometry {

namespace {
/** Runs a stage and adds its time. */
template <typename Work>
auto stage(const char* name, Step& step, const Work& work) {
    const StageTimer timer(step, name);
    return work();
}

/** The registration's own times and figures. */
void note(const PaperRegistration& found, bool guarded, Step& step) {
    step.times_ms.emplace_back("rotation", found.rotation_ms);
    step.times_ms.emplace_back("translation", found.translation_ms);
    if (guarded) step.times_ms.emplace_back("guards", found.guards_ms);
    const auto put = [&](const char* name, double value) {
        step.details.emplace_back(name, value);
    };
    put("overlap", found.translation.overlap);
    put("rotation_iterations", found.rotation.iterations);
    put("rotation_converged", found.rotation.converged);
    put("translation_iterations", found.translation.iterations);
    put("translation_converged", found.translation.converged);
    if (guarded) put("denied", found.denied);
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

PaperRegistration registerByPatternAndLines(const PaperFeatures& from, const PaperFeatures& to,
                                            const Eigen::Isometry3d& guess, double search_m,
                                            const PaperOdometryOptions& options) {
    PaperRegistration result;
    result.rotation = timed(result.rotation_ms, [&] {
        return paper::registerPatterns(from.pattern, to.pattern, guess.linear(), options.pattern);
    });
    result.translation = timed(result.translation_ms, [&] {
        const auto unrotated = paper::rotated(to.lines, result.rotation.rotation);
        return paper::searchTranslation(from.lines, unrotated, guess.translation(), search_m,
                                        options.lineRegistration);
    });
    if (!result.rotation.valid)
        result.predictedReason = result.rotation.tooFar ? "no rotation found" : "too few normals";
    if (!result.translation.valid)
        result.predictedReason += result.rotation.valid ? "too few lines" : " and too few lines";
    return result;
}

std::optional<Link> PaperFeatures::linkTo(const ScanFeatures& earlier,
                                          const Eigen::Isometry3d& guess) const {
    const auto& from = dynamic_cast<const PaperFeatures&>(earlier);
    auto found = registerByPatternAndLines(from, *this, guess, 0, *options);
    if (!found.predictedReason.empty()) return {};
    if (!applyGuardsToLink(from, *this, guess, *options, found)) return {};
    return Link{incrementOf(found, *options), found.translation.overlap};
}

PaperRegistration registerFeatures(const PaperFeatures& from, const PaperFeatures& to,
                                   const Eigen::Isometry3d& guess, double search_m,
                                   const PaperOdometryOptions& options) {
    auto found = registerByPatternAndLines(from, to, guess, search_m, options);
    applyGuards(from, to, guess, options, found);
    found.increment = incrementOf(found, options);
    return found;
}

std::shared_ptr<const PaperFeatures> featuresOf(
    const PointCloud& cloud, const Eigen::Matrix3f& upright, unsigned number,
    const std::shared_ptr<const PaperOdometryOptions>& options, Step& step) {
    auto features = std::make_shared<PaperFeatures>();
    features->options = options;
    const auto raw = stage("normals", step,
                           [&] { return paper::estimateNormals(cloud.points, options->normals); });
    const auto normals =
        stage("bilateral", step, [&] { return paper::filterBilaterally(raw, options->bilateral); });
    features->pattern =
        stage("outliers", step, [&] { return paper::removeOutliers(normals, options->outliers); });
    std::size_t modes = 0;  // 0 where they are not needed
    features->pattern = stage("mean_shift", step, [&] {
        if (!paper::needsModes(features->pattern, options->meanShift)) return features->pattern;
        const auto found = paper::seekModes(normals.directions, options->meanShift);
        modes = found.size();
        return paper::patternOfModes(normals, found, options->meanShift, options->outliers);
    });
    paper::weighGround(features->pattern, upright.transpose().col(2), options->pattern);
    // Another draw for every scan: of two scans made from nearly one place, the same draw gives
    // nearly the same lines, each of which then pairs with itself and holds the vehicle at rest.
    auto lineOptions = options->lines;
    lineOptions.seed += number;
    features->lines = stage("lines", step, [&] {
        const auto drawn = paper::drawLines(upright * cloud.points, cloud.rings, lineOptions);
        return paper::rotated(drawn, upright.transpose().cast<double>());
    });
    if (options->check.enabled)
        features->check = stage("check_points", step, [&] {
            return checkPointsOf(cloud.points, upright, options->check, options->pointMap);
        });
    step.details = {{"normals", static_cast<double>(normals.directions.cols())},
                    {"pattern", static_cast<double>(features->pattern.directions.cols())},
                    {"modes", static_cast<double>(modes)},
                    {"lines", static_cast<double>(features->lines.midpoints.cols())}};
    return features;
}

PaperOdometry::PaperOdometry(const PaperOdometryOptions& options)
    : options_(std::make_shared<PaperOdometryOptions>(options)),
      arrivals_(needsTimes(options.scan)),
      prediction_(options.prediction) {}

/** The paper's rings and sectors are about z. */
Eigen::Matrix3f PaperOdometry::upright() const {
    return upright_.value_or(Eigen::Matrix3f::Identity());
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
    const auto features =
        featuresOf(skipped.empty() ? cloud : PointCloud{}, upright(), scans_++, options_, step);
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
    note(registration, options_->guarded(), step);
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
