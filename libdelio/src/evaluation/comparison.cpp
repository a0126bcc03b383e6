#include "delio/evaluation/comparison.h"

#include <mrpt/core/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/evaluation/metrics.h"

namespace delio::evaluation {
using mrpt::format;

namespace {
/** Index of the stamp nearest to `t`, the earlier of two that are as near. */
std::size_t nearest(const std::vector<double>& stamps, double t) {
    const auto after = std::lower_bound(stamps.begin(), stamps.end(), t);
    if (after == stamps.begin()) return 0;
    const auto index = static_cast<std::size_t>(after - stamps.begin());
    return after == stamps.end() || t - *(after - 1) <= *after - t ? index - 1 : index;
}

Association byRow(const io::Trajectory& reference, const io::Trajectory& estimate) {
    const std::size_t wanted = reference.poses.size(), found = estimate.poses.size();
    if (wanted != found)
        throw Error("the estimate has " + std::to_string(found) + " poses, the reference " +
                    std::to_string(wanted) +
                    "; without time stamps (TUM format) both need the same number");
    Association result;
    result.reference = reference.poses;
    result.estimate = estimate.poses;
    result.estimateRows.resize(found);
    std::iota(result.estimateRows.begin(), result.estimateRows.end(), std::size_t{0});
    result.stamps_s = reference.stamps_s.empty() ? estimate.stamps_s : reference.stamps_s;
    return result;
}

Association byStamp(const io::Trajectory& reference, const io::Trajectory& estimate,
                    double tolerance_s) {
    Association result;
    for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
        const double t = estimate.stamps_s[i];
        const std::size_t j = nearest(reference.stamps_s, t);
        const double tReference = reference.stamps_s[j];
        if (std::abs(t - tReference) > tolerance_s || nearest(estimate.stamps_s, tReference) != i)
            continue;
        result.reference.push_back(reference.poses[j]);
        result.estimate.push_back(estimate.poses[i]);
        result.estimateRows.push_back(i);
        result.stamps_s.push_back(tReference);
    }
    result.unmatchedReference = reference.poses.size() - result.reference.size();
    result.unmatchedEstimate = estimate.poses.size() - result.estimate.size();
    return result;
}

constexpr double kStep_m = 1;         // long enough for a direction that noise does not hide
constexpr double kLeastStep_m = 0.2;  // of short paths: true poses are good to a few centimetres
constexpr int kStepsToTell = 3;       // fewer say too little
constexpr double kDisagree = 0.5;     // mean cosines
constexpr double kAgree = 0.9;

double metresBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (b.translation() - a.translation()).norm();
}

/** How far apart poses have to be to give a direction: shorter where the path is short. */
double stepFor(const std::vector<Eigen::Isometry3d>& poses) {
    return std::clamp(pathLength_m(poses) / (2 * kStepsToTell), kLeastStep_m, kStep_m);
}

/** Displacement from pose `a` to pose `b`, in the axes of `a`. */
Eigen::Vector3d direction(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.inverse() * b).translation().normalized();
}

/** Mean of those of the rows' figures that exist. */
template <typename Figure>
double meanOf(const std::vector<ReportRow>& rows, const Figure& figure) {
    double sum = 0, count = 0;
    for (const auto& row : rows) {
        if (!std::isfinite(figure(row))) continue;
        sum += figure(row);
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

constexpr double kScans = 16, kTolerance_m = 0.005, kMany = 0.05;

bool isOfKitti00sHead(const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d step(-0.04686, -0.02836, 0.85819);  // the official poses' own, metres
    const Eigen::Vector3d position = pose.translation();
    const double scan = std::round(position.z() / step.z());
    return scan >= 1 && scan < kScans && (position - scan * step).norm() < kTolerance_m;
}

constexpr double kKittiInterval_s = 0.1;

const char* textOf(FrameMismatch mismatch) {
    return mismatch == FrameMismatch::lidarAgainstCamera
               ? "the estimate seems to be in the LiDAR frame (x forward), the reference in the "
                 "camera frame (z forward)"
               : "the estimate seems to be in the camera frame (z forward), the reference in the "
                 "LiDAR frame (x forward)";
}

/** Keeps the rows of the scans that were used; gives the count of the others. */
std::size_t dropUnused(io::Trajectory& reference, const io::ScanTable& table) {
    const std::size_t rows = reference.poses.size();
    const auto& scans = table.scans;
    if (!reference.stamps_s.empty() || rows == scans.size() || scans.empty()) return 0;
    if (scans.back() >= rows)
        throw Error(
            format("the ground truth has %zu rows but scan %zu was used", rows, scans.back()));
    std::vector<Eigen::Isometry3d> used;
    used.reserve(scans.size());
    for (const std::size_t scan : scans) used.push_back(reference.poses[scan]);
    reference.poses = std::move(used);
    return rows - scans.size();
}

void setTimes(Comparison& comparison, const Association& pairs, const io::ScanTable* scans) {
    for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
        const std::size_t row = pairs.estimateRows[i];
        if (!pairs.stamps_s.empty())
            comparison.times_s.push_back(pairs.stamps_s[i] - pairs.stamps_s[0]);
        else if (scans)
            comparison.times_s.push_back(scans->stamps_s[row] - scans->stamps_s[0]);
        else
            comparison.times_s.push_back(kKittiInterval_s * static_cast<double>(i));
        if (scans) comparison.predicted.push_back(scans->predicted[row]);
    }
    comparison.timesAreAssumed = pairs.stamps_s.empty() && !scans;
}

std::vector<double> lengthsFor(const std::vector<Eigen::Isometry3d>& reference,
                               const ComparisonSettings& settings) {
    if (!settings.lengths_m.empty()) return settings.lengths_m;
    const double path_m = pathLength_m(reference);
    auto lengths = kittiLengths_m();
    return path_m < 2 * lengths.front() ? suggestedLengths_m(path_m) : lengths;
}

/** Position of the last pose relative to the first; the origin without poses. */
Eigen::Vector3d endOf(const std::vector<Eigen::Isometry3d>& poses) {
    if (poses.empty()) return Eigen::Vector3d::Zero();
    return (poses.front().inverse() * poses.back()).translation();
}
}  // namespace

Association associate(const io::Trajectory& reference, const io::Trajectory& estimate,
                      double tolerance_s) {
    if (reference.stamps_s.empty() || estimate.stamps_s.empty()) return byRow(reference, estimate);
    auto result = byStamp(reference, estimate, tolerance_s);
    if (result.estimate.empty())
        throw Error("no pose of the estimate is within " + digitsOf(tolerance_s) +
                    " s of a pose of the reference; check that both use the same clock");
    return result;
}

FrameMismatch findFrameMismatch(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate) {
    Eigen::Matrix3d lidarToCamera;
    lidarToCamera << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    double asIs = 0, fromLidar = 0, fromCamera = 0;
    int steps = 0;
    std::size_t begin = 0;
    const double step_m = stepFor(reference);
    for (std::size_t i = 1; i < reference.size(); ++i) {
        if (metresBetween(reference[begin], reference[i]) < step_m) continue;
        const Eigen::Vector3d wanted = direction(reference[begin], reference[i]);
        const Eigen::Vector3d found = direction(estimate[begin], estimate[i]);
        asIs += wanted.dot(found);
        fromLidar += wanted.dot(lidarToCamera * found);
        fromCamera += wanted.dot(lidarToCamera.transpose() * found);
        ++steps;
        begin = i;
    }
    if (steps < kStepsToTell)
        return steps > 0 && asIs > kAgree * steps ? FrameMismatch::none : FrameMismatch::unknown;
    if (asIs >= kDisagree * steps) return FrameMismatch::none;
    if (fromLidar > kAgree * steps) return FrameMismatch::lidarAgainstCamera;
    if (fromCamera > kAgree * steps) return FrameMismatch::cameraAgainstLidar;
    return FrameMismatch::none;
}

bool movesAlongZ(const std::vector<Eigen::Isometry3d>& poses) {
    double alongX = 0, alongZ = 0;
    std::size_t begin = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
        if (metresBetween(poses[begin], poses[i]) < kStep_m) continue;
        const Eigen::Vector3d step = direction(poses[begin], poses[i]);
        alongX += std::abs(step.x());
        alongZ += std::abs(step.z());
        begin = i;
    }
    return alongZ > alongX;
}

ReportRow score(const std::vector<Eigen::Isometry3d>& reference,
                const std::vector<Eigen::Isometry3d>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta) {
    const auto relative = relativeError(reference, estimate, delta);
    ReportRow row;
    row.length_m = pathLength_m(reference);
    row.kitti = kittiErrors(reference, estimate, lengths_m);
    row.ape_m = absoluteError(reference, estimate).rmse_m;
    row.rpe_m = relative.translation_m.rmse;
    row.rpe_deg = relative.rotation_deg.rmse;
    return row;
}

ReportRow averageOf(const std::vector<ReportRow>& rows) {
    ReportRow average;
    average.name = rows.front().name;
    average.sequence = "avg";
    for (const auto& row : rows) {
        average.length_m += row.length_m;
        average.kitti.segments += row.kitti.segments;
    }
    average.kitti.t_percent = meanOf(rows, [](const ReportRow& r) { return r.kitti.t_percent; });
    average.kitti.r_deg_per_100m =
        meanOf(rows, [](const ReportRow& r) { return r.kitti.r_deg_per_100m; });
    average.ape_m = meanOf(rows, [](const ReportRow& r) { return r.ape_m; });
    average.rpe_m = meanOf(rows, [](const ReportRow& r) { return r.rpe_m; });
    average.rpe_deg = meanOf(rows, [](const ReportRow& r) { return r.rpe_deg; });
    return average;
}

std::string knownFaultOf(const std::vector<Eigen::Isometry3d>& reference) {
    const auto wrong = std::count_if(reference.begin(), reference.end(), isOfKitti00sHead);
    if (wrong < 2 || static_cast<double>(wrong) < kMany * static_cast<double>(reference.size()))
        return "";
    return std::to_string(wrong) + " of the " + std::to_string(reference.size()) +
           " ground-truth poses are KITTI's official ones for the first 16 scans of sequence 00, "
           "which are wrong (12.9 m of path instead of 11.7 m); the errors are meaningless, use "
           "scans from 16 on or another sequence";
}

double Comparison::endError_percent() const {
    constexpr double kLeast_m = 0.1;
    if (!(row.length_m >= kLeast_m)) return std::numeric_limits<double>::quiet_NaN();
    return 100 * end_error_m / row.length_m;
}

WrongFrames::WrongFrames(FrameMismatch found) : Error(textOf(found)), mismatch_(found) {}

Comparison compare(io::Trajectory reference, const io::Trajectory& estimate,
                   const ComparisonSettings& settings, const io::ScanTable* scans) {
    if (scans && scans->scans.size() != estimate.poses.size())
        throw Error(format("the estimate has %zu poses but its scan table has %zu scans",
                           estimate.poses.size(), scans->scans.size()));
    Comparison comparison;
    if (scans) comparison.unusedReference = dropUnused(reference, *scans);
    auto pairs = associate(reference, estimate);
    const auto mismatch = findFrameMismatch(pairs.reference, pairs.estimate);
    comparison.framesAreUnknown = mismatch == FrameMismatch::unknown;
    if (mismatch != FrameMismatch::none && !comparison.framesAreUnknown)
        throw WrongFrames(mismatch);
    comparison.referenceFault = knownFaultOf(pairs.reference);
    setTimes(comparison, pairs, scans);
    comparison.unmatchedReference = pairs.unmatchedReference;
    comparison.unmatchedEstimate = pairs.unmatchedEstimate;
    comparison.reference = std::move(pairs.reference);
    comparison.estimate = std::move(pairs.estimate);
    comparison.row = score(comparison.reference, comparison.estimate,
                           lengthsFor(comparison.reference, settings), settings.delta);
    comparison.perScan = relativeError(comparison.reference, comparison.estimate);
    comparison.end_error_m = (endOf(comparison.reference) - endOf(comparison.estimate)).norm();
    return comparison;
}
}  // namespace delio::evaluation
