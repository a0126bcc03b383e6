#include "stamp_order.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace delio::io {
namespace {
constexpr double kApart = 0.6;        // of the usual interval, at least
constexpr double kMostUnknown_s = 1;  // scans are sorted over, where that is not known
}  // namespace

bool StampOrder::isNext(const Scan& first) const {
    constexpr double kMost = 2 * kApart;  // a scan that is apart from this one lies after it
    if (!latest_s_) return startsInOrder_;
    if (passedOver_ > 0 || isLate(first)) return false;
    if (isStart()) return startsInOrder_ && stampOf(first) < *latest_s_ + kMostUnknown_s;
    return stampOf(first) < *latest_s_ + kMost * usual_s_;
}

bool StampOrder::isClockSet(const std::deque<Scan>& ahead) const {
    const auto late = [&](const Scan& scan) { return isLate(scan); };
    return (wasSet_ || ahead.size() >= kWindow) && std::all_of(ahead.begin(), ahead.end(), late);
}

/** True if sorted scans have the usual interval, which a scan with a wrong stamp has not. */
std::size_t StampOrder::earliestOf(const std::deque<Scan>& ahead) const {
    std::size_t earliest = 0;
    for (std::size_t i = 1; i < std::min(kWindow, ahead.size()); ++i) {
        const bool isApart = !latest_s_ || stampOf(ahead[i]) > *latest_s_ + kApart * usual_s_;
        if (isApart && ahead[i].stamp_s < ahead[earliest].stamp_s) earliest = i;
    }
    const double gained_s = ahead.front().stamp_s - ahead[earliest].stamp_s;
    const bool isFar = usual_s_ == 0 && gained_s > kMostUnknown_s;
    return gained_s > kApart * usual_s_ && !isFar ? earliest : 0;
}

/** True where the first scan ahead is not one to be given, now or later. Another one comes
 *  `gained_s` before it. */
bool StampOrder::isOutOfOrder(const std::deque<Scan>& ahead, double gained_s) const {
    const Scan& first = ahead.front();
    const double least_s = kApart * usual_s_;
    if (isLate(first)) return true;
    if (usual_s_ == 0 || (gained_s == 0 && passedOver_ == 0)) return false;
    if (gained_s > kWindow * usual_s_ || (gained_s > 0 && passedOver_ + 1 >= kWindow)) return true;
    // A scan that belongs later has a gap there.
    const auto isNear = [&](const Scan& other) {
        return std::abs(other.stamp_s - first.stamp_s) < least_s;
    };
    return stampOf(first) < *latest_s_ + least_s ||
           std::any_of(ahead.begin() + 1, ahead.end(), isNear);
}

/** A scan that is missing does not make another interval the usual one. */
void StampOrder::learn(double passed_s) {
    constexpr double kChange = 1.2;
    usual_s_ = isStart() ? passed_s : std::clamp(passed_s, usual_s_ / kChange, usual_s_ * kChange);
    ++intervals_;
}

Scan StampOrder::give(std::deque<Scan>& ahead, std::size_t place) {
    const auto at = ahead.begin() + static_cast<std::ptrdiff_t>(place);
    Scan scan = std::move(*at);
    ahead.erase(at);
    const double stamp_s = stampOf(scan);
    if (added_s_ != 0) {
        scan.stamp_s = stamp_s;
        scan.time += std::chrono::duration_cast<mrpt::Clock::duration>(
            std::chrono::duration<double>(added_s_));
    }
    if (latest_s_ && stamp_s > *latest_s_) learn(stamp_s - *latest_s_);
    latest_s_ = stamp_s;
    passedOver_ = place == 0 ? 0 : passedOver_ + 1;
    return scan;
}

std::optional<Scan> StampOrder::take(std::deque<Scan>& ahead) {
    constexpr double kOfASpinningLidar_s = 0.1;
    const std::size_t index = ahead.front().index;
    if (isNext(ahead.front())) {
        wasSet_ = false;
        return give(ahead, 0);
    }
    if (isClockSet(ahead)) {
        findings_.add(
            "stamps do not increase (clock set back or stopped): continued from the previous scan",
            index);
        const double passed_s = usual_s_ > 0 ? usual_s_ : kOfASpinningLidar_s;
        added_s_ = *latest_s_ + passed_s - ahead.front().stamp_s;
        wasSet_ = true;
        return give(ahead, 0);
    }
    wasSet_ = false;
    const std::size_t place = earliestOf(ahead);
    if (isOutOfOrder(ahead, ahead.front().stamp_s - ahead[place].stamp_s)) {
        findings_.add("scans with a stamp out of order: ignored", index);
        ahead.pop_front();
        passedOver_ = 0;
        return {};
    }
    if (place > 0)
        findings_.add("scans recorded out of order: sorted by stamp", ahead[place].index);
    return give(ahead, place);
}
}  // namespace delio::io
