#include "core/timeline.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace delio {
/** The median of the latest intervals. */
double Timeline::usual_s() const {
    constexpr double kOfASpinningLidar_s = 0.1;
    if (latest_s_.empty()) return kOfASpinningLidar_s;
    std::vector<double> sorted(latest_s_.begin(), latest_s_.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
}

Interval Timeline::advance(double stamp_s, bool isCopy) {
    constexpr double kLongest_s = 1, kLongestOfUsual = 5, kShortestOfUsual = 0.2, kAtOnce_s = 1e-6;
    constexpr std::size_t kMemory = 9;
    const double elapsed_s = stamp_s - stamp_s_, usual = usual_s();
    Interval interval{IntervalKind::kUsual, usual, usual};
    if (started_ && std::abs(elapsed_s) > std::max(kLongest_s, kLongestOfUsual * usual)) {
        interval.kind = IntervalKind::kUnknown;
        interval.elapsed_s = std::abs(elapsed_s);
    } else if (started_ && elapsed_s > 0) {
        if (elapsed_s < kShortestOfUsual * usual) interval.kind = IntervalKind::kShort;
        interval.duration_s = interval.elapsed_s = elapsed_s;
        latest_s_.push_back(elapsed_s);
        if (latest_s_.size() > kMemory) latest_s_.pop_front();
    } else if (started_ && isCopy)
        interval = {IntervalKind::kShort, kAtOnce_s, kAtOnce_s};
    if (started_) sinceStart_s_ += interval.duration_s;
    started_ = true;
    stamp_s_ = stamp_s;
    return interval;
}
}  // namespace delio
