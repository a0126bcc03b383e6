#include "delio/evaluation/comparison.h"

#include <mrpt/core/format.h>

#include <limits>

#include "delio/evaluation/association.h"
#include "delio/evaluation/kitti_metric.h"
#include "known_faults.h"

namespace delio::evaluation {
using mrpt::format;

namespace {
constexpr double kKittiInterval_s = 0.1;

const char* textOf(FrameMismatch mismatch) {
    return mismatch == FrameMismatch::lidarAgainstCamera
               ? "the estimate looks like it is in the LiDAR frame (x forward), the reference in "
                 "the camera frame (z forward)"
               : "the estimate looks like it is in the camera frame (z forward), the reference in "
                 "the LiDAR frame (x forward)";
}

/** Keeps the rows of the scans that were used; gives the count of the others. */
std::size_t dropUnused(io::Trajectory& reference, const io::ScanTable& table) {
    const std::size_t rows = reference.poses.size();
    const auto& scans = table.scans;
    if (!reference.stamps_s.empty() || rows == scans.size() || scans.empty()) return 0;
    if (scans.back() >= rows)
        throw Error(
            format("the true poses have %zu rows but scan %zu was used", rows, scans.back()));
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

/** Where the last pose is, seen from the first; the origin where there is none. */
Eigen::Vector3d endOf(const std::vector<Eigen::Isometry3d>& poses) {
    if (poses.empty()) return Eigen::Vector3d::Zero();
    return (poses.front().inverse() * poses.back()).translation();
}
}  // namespace

double Comparison::endError_percent() const {
    constexpr double kLeast_m = 0.1;
    if (!(row.length_m >= kLeast_m)) return std::numeric_limits<double>::quiet_NaN();
    return 100 * end_error_m / row.length_m;
}

WrongFrames::WrongFrames(FrameMismatch found) : Error(textOf(found)), mismatch_(found) {}

Comparison compare(io::Trajectory reference, const io::Trajectory& estimate,
                   const ComparisonSettings& settings, const io::ScanTable* scans) {
    if (scans && scans->scans.size() != estimate.poses.size())
        throw Error(format("the estimate has %zu poses, its table %zu scans", estimate.poses.size(),
                           scans->scans.size()));
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
