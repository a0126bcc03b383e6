#include "delio/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "delio/core/error.h"
#include "delio/core/numbers.h"

namespace delio::evaluation {
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
                    "; without time stamps in both (TUM files) they must be as many");
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
}  // namespace

Association associate(const io::Trajectory& reference, const io::Trajectory& estimate,
                      double tolerance_s) {
    if (reference.stamps_s.empty() || estimate.stamps_s.empty()) return byRow(reference, estimate);
    auto result = byStamp(reference, estimate, tolerance_s);
    if (result.estimate.empty())
        throw Error("no pose of the estimate is within " + digitsOf(tolerance_s) +
                    " s of one of the reference; do their time stamps share a clock?");
    return result;
}
}  // namespace delio::evaluation
