#include "point_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::io {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewest = 8;  // points, of which some are of another part of a turn

/** Times of measured points (a sample of large scans). Zeros are ignored: many drivers write 0 for
 *  "no time". */
std::vector<double> sampleOf(const RecordedTimes& times) {
    constexpr std::size_t kEnough = 8192;
    std::vector<double> values;
    for (std::size_t i = 0; i < times.values.size(); i += 1 + times.values.size() / kEnough)
        if (times.isMeasured[i] && std::isfinite(times.values[i]) && times.values[i] != 0)
            values.push_back(times.values[i]);
    return values;
}

double quantile(std::vector<double>& values, double share) {
    const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

std::string nameOf(double unit_s) {
    return unit_s > 0.1 ? "s" : unit_s > 1e-4 ? "ms" : unit_s > 1e-7 ? "us" : "ns";
}
}  // namespace

std::optional<PointClock::Range> PointClock::rangeOf(const RecordedTimes& times) {
    constexpr double kTail = 0.02;
    auto values = sampleOf(times);
    if (values.size() < kFewest) return {};
    Range range{quantile(values, kTail), quantile(values, 1 - kTail), values.size(), times.stamp_s};
    if (!(range.last > range.first)) return {};
    return range;
}

/** Brings times that passed 2^32 to the side where most are; says how many. */
std::size_t PointClock::unwrap(RecordedTimes& times) const {
    constexpr double kTurn = 4294967296.0;
    if (!times.is32Bit) return 0;
    auto values = sampleOf(times);
    if (values.empty()) return 0;
    const double middle = quantile(values, 0.5);
    std::size_t wrapped = 0;
    for (std::size_t i = 0; i < times.values.size(); ++i) {
        const double turns = std::round((middle - times.values[i]) / kTurn);
        if (!(std::abs(turns) == 1)) continue;
        times.values[i] += turns * kTurn;
        wrapped += times.isMeasured[i];
    }
    return wrapped;
}

PointClock::Zero PointClock::zeroOf(const std::vector<Range>& scans, double unit_s) {
    constexpr double kNear_s = 2;
    std::size_t ofUnix = 0, own = 0, grown = 0;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto& [first, last, count, stamp_s] = scans[i];
        if (std::abs(first * unit_s - stamp_s) < kNear_s && stamp_s > kNear_s)
            ++ofUnix;
        else if (std::max(std::abs(first), std::abs(last)) * unit_s >= 1)
            ++own;
        if (i == 0) continue;
        const double passed_s = stamp_s - scans[i - 1].stamp_s;
        grown += passed_s > 0 && (first - scans[i - 1].first) * unit_s > passed_s / 2;
    }
    if (2 * ofUnix > scans.size()) return Zero::kUnix;
    // Times that go on from scan to scan do not count from their stamps.
    const bool isGoingOn = scans.size() > 2 && 4 * grown >= 3 * (scans.size() - 1);
    return isGoingOn || 2 * own > scans.size() ? Zero::kFirstPoint : Zero::kStamp;
}

/** A turn takes from 1 ms to 1 s: one unit fits. */
PointClock::Clock PointClock::clockOf(const std::vector<Range>& scans) {
    std::vector<double> durations;
    durations.reserve(scans.size());
    for (const auto& scan : scans) durations.push_back(scan.last - scan.first);
    std::sort(durations.begin(), durations.end());
    const double usual = durations[(durations.size() - 1) / 2];
    Clock clock;
    while (clock.unit_s > 1e-9 && usual * clock.unit_s >= 1) clock.unit_s *= 1e-3;
    std::vector<Range> whole;
    for (const auto& scan : scans)
        if ((scan.last - scan.first) * clock.unit_s < 1) whole.push_back(scan);
    clock.zero = zeroOf(whole, clock.unit_s);
    return clock;
}

bool PointClock::fits(const Clock& clock, const Range& range) {
    constexpr double kLongest_s = 1, kShortest_s = 1e-4;
    constexpr std::size_t kMany = 100;  // few points may lie close to each other
    const double duration_s = (range.last - range.first) * clock.unit_s;
    if (duration_s >= kLongest_s) return false;
    if (duration_s < kShortest_s && range.count >= kMany) return false;
    if (clock.zero == Zero::kFirstPoint) return true;
    const double zero_s = clock.zero == Zero::kUnix ? range.stamp_s : 0;
    return std::abs(range.first * clock.unit_s - zero_s) <= kLongest_s &&
           std::abs(range.last * clock.unit_s - zero_s) <= kLongest_s;
}

bool PointClock::look(RecordedTimes times) {
    constexpr std::size_t kScans = 5;
    unwrap(times);
    if (const auto range = rangeOf(times)) seen_.push_back(*range);
    return seen_.size() < kScans;
}

/** False: the scan's times do not fit. Three such scans that agree with each other change the
 *  clock. */
bool PointClock::accepts(const Range& range, std::size_t scan) {
    constexpr std::size_t kPatience = 3;
    if (!clock_) {
        if (seen_.empty()) seen_ = {range};
        clock_ = clockOf(seen_);
        goesOn_ = clock_->zero == Zero::kFirstPoint && std::abs(seen_[0].last) * clock_->unit_s < 1;
    }
    if (fits(*clock_, range)) {
        contradictions_ = 0;
        return true;
    }
    const Clock other = clockOf({range});
    contradictions_ = other_ && *other_ == other ? contradictions_ + 1 : 1;
    other_ = other;
    if (contradictions_ < kPatience || !fits(other, range)) return false;
    findings_.add("point times are in " + nameOf(other.unit_s) + " from here on instead of " +
                      nameOf(clock_->unit_s) + " or have another zero",
                  scan);
    clock_ = other;
    goesOn_ = false;
    contradictions_ = 0;
    return true;
}

/** Unix times show missing scans, and scans that are not in the order of measurement. */
void PointClock::watch(double first, const Range& range, std::size_t scan) {
    constexpr double kFirstUnix_s = 5e8, kMany = 3, kUsual_s = 0.1;
    const double first_s = first * clock_->unit_s;
    if (clock_->zero != Zero::kFirstPoint || first_s < kFirstUnix_s) return;
    Passed now{first_s, range.stamp_s, latest_ ? latest_->usual_s : 0};
    if (latest_) {
        const double passed_s = first_s - latest_->first_s;
        const double stamped_s = std::max(range.stamp_s - latest_->stamp_s, kUsual_s);
        const bool isLate =
            now.usual_s > 0 && passed_s > kMany * now.usual_s && passed_s > kMany * stamped_s;
        if (passed_s <= 0 || isLate)
            findings_.add("point times jump but stamps do not (scans are missing or out of order)",
                          scan);
        else
            now.usual_s = passed_s;
    }
    latest_ = now;
}

std::vector<float> PointClock::secondsOf(RecordedTimes times) {
    const std::size_t wrapped = unwrap(times);
    const auto range = rangeOf(times);
    if (!range) return {};
    if (!accepts(*range, times.scan)) {
        findings_.add("invalid point times: scans used without times", times.scan);
        return {};
    }
    if (goesOn_)
        findings_.add("point times continue across scans: counted from each scan's first point",
                      times.scan);
    if (wrapped > 0) findings_.add("point times wrapped at 2^32: corrected", times.scan, wrapped);
    const double length = range->last - range->first;
    const auto isNear = [&](double time, double margin) {
        // A zero that is farther from the others is no time.
        if (time == 0) margin = std::max(0.05, 2.0 / static_cast<double>(range->count));
        return time >= range->first - margin * length && time <= range->last + margin * length;
    };
    double first = range->last, zero = 0;
    for (const double time : times.values)
        if (isNear(time, 0.25)) first = std::min(first, time);
    watch(first, *range, times.scan);
    if (clock_->zero == Zero::kFirstPoint) zero = first;
    if (clock_->zero == Zero::kUnix) zero = times.stamp_s / clock_->unit_s;
    std::vector<float> seconds;
    seconds.reserve(times.values.size());
    std::size_t impossible = 0;
    for (std::size_t i = 0; i < times.values.size(); ++i) {
        const double time_s = (times.values[i] - zero) * clock_->unit_s;
        const bool isPossible = isNear(times.values[i], 3) && std::abs(time_s) <= 1;
        seconds.push_back(static_cast<float>(isPossible ? time_s : kNan));
        impossible += !isPossible && times.isMeasured[i];
    }
    if (impossible > 0)
        findings_.add("points without a valid time: ignored", times.scan, impossible);
    return seconds;
}
}  // namespace delio::io
