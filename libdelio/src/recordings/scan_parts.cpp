#include "scan_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace delio::io {
void append(Scan& scan, const Scan& part) {
    const std::size_t before = scan.points->size(), added = part.points->size();
    const auto shift_s = static_cast<float>(part.stamp_s - scan.stamp_s);
    const bool haveRings = scan.rings.size() == before && part.rings.size() == added,
               haveTimes = scan.times_s.size() == before && part.times_s.size() == added;
    *scan.points += *part.points;
    scan.rings.insert(scan.rings.end(), part.rings.begin(), part.rings.end());
    for (const float time_s : part.times_s) scan.times_s.push_back(time_s + shift_s);
    if (!haveRings) scan.rings.clear();
    if (!haveTimes) scan.times_s.clear();
}

namespace {
constexpr double kScan_s = 0.1;
constexpr std::size_t kMostPoints = 2'000'000;  // of joined messages

/** Seconds from the stamp to the last point. */
double durationOf(const Scan& scan) {
    double last_s = 0;
    for (const float time_s : scan.times_s)
        if (std::isfinite(time_s)) last_s = std::max(last_s, static_cast<double>(time_s));
    return last_s;
}
}  // namespace

void PatternJoiner::add(Scan part) {
    const double since_s = begun_ ? part.stamp_s - begun_->stamp_s : 0;
    const bool continues = begun_ && part.stamp_s > latest_s_ &&
                           since_s + durationOf(part) / 2 < kScan_s &&
                           begun_->points->size() + part.points->size() <= kMostPoints;
    if (begun_ && !continues) close();
    latest_s_ = part.stamp_s;
    ++parts_;
    if (!begun_)
        begun_ = std::move(part);
    else
        append(*begun_, part);
}

void PatternJoiner::close() {
    joined_ += parts_ > 1;
    parts_ = 0;
    ready_.push_back(std::move(*begun_));
    begun_.reset();
}

void PatternJoiner::finish() {
    if (begun_) close();
}

std::optional<Scan> PatternJoiner::take() {
    if (ready_.empty()) return {};
    Scan scan = std::move(ready_.front());
    ready_.pop_front();
    return scan;
}

std::optional<double> PatternJoiner::begun_s() const {
    if (!begun_) return {};
    return begun_->stamp_s;
}
}  // namespace delio::io
