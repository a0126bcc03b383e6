#include "delio/run/doubts.h"

#include <mrpt/core/format.h>

namespace delio::run {
namespace {
template <typename IsOfKind>
Stretches stretchesOf(const std::vector<RunRow>& rows, const IsOfKind& isOfKind) {
    Stretches found;
    std::size_t inRow = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        inRow = isOfKind(rows[i].report.step) ? inRow + 1 : 0;
        found.scans += inRow > 0;
        if (inRow <= found.longest) continue;
        found.longest = inRow;
        found.from = rows[i + 1 - inRow].scan;
    }
    return found;
}

std::string countOf(const Stretches& found, std::size_t pairs) {
    return mrpt::format("%zu of %zu scans (at most %zu in a row, from scan %zu)", found.scans,
                        pairs, found.longest, found.from);
}
}  // namespace

Doubts doubtsOf(const std::vector<RunRow>& rows) {
    Doubts doubts;
    doubts.pairs = rows.empty() ? 0 : rows.size() - 1;
    doubts.predicted = stretchesOf(rows, [](const Step& step) { return step.predicted; });
    doubts.weak = stretchesOf(rows, [](const Step& step) {
        return !step.predicted && (step.quality.unobservedRotation.cols() > 0 ||
                                   step.quality.unobservedTranslation.cols() > 0);
    });
    doubts.interrupted = stretchesOf(rows, [](const Step& step) { return step.interrupted; });
    return doubts;
}

std::vector<std::string> warningsOf(const Doubts& doubts) {
    constexpr double kMany = 0.05;
    const double many = kMany * static_cast<double>(doubts.pairs);
    std::vector<std::string> warnings;
    if (static_cast<double>(doubts.predicted.scans) > many)
        warnings.push_back(countOf(doubts.predicted, doubts.pairs) +
                           " could not be registered: their motion is a prediction; scans.csv says "
                           "why");
    if (static_cast<double>(doubts.weak.scans) > many)
        warnings.push_back(countOf(doubts.weak, doubts.pairs) +
                           " were observed weakly: along the axes in scans.csv the motion is a "
                           "prediction");
    if (doubts.interrupted.scans > 0)
        warnings.push_back(countOf(doubts.interrupted, doubts.pairs) +
                           " follow a pause, or a clock that was set: the motion before them was "
                           "searched for, not predicted");
    return warnings;
}
}  // namespace delio::run
