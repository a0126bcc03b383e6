#include "delio/recordings/scan_feed.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace delio::io {
namespace {
/** Samples of a drive whose scans stay away. */
constexpr std::size_t kMostSamples = 100'000;

template <typename Sample>
void appendBounded(std::vector<Sample>& samples, const std::vector<Sample>& more) {
    samples.insert(samples.end(), more.begin(), more.end());
    if (samples.size() > kMostSamples)
        samples.erase(samples.begin(), samples.end() - kMostSamples / 2);
}

/** Of a scan that is dropped, before those of the next one. */
template <typename Sample>
void passOn(std::vector<Sample> samples, std::vector<Sample>& next) {
    appendBounded(samples, next);
    next = std::move(samples);
}
}  // namespace

ScanFeed::ScanFeed(std::size_t mostWaiting, std::function<void()> onFirstDrop)
    : mostWaiting_(std::max<std::size_t>(mostWaiting, 1)), onFirstDrop_(std::move(onFirstDrop)) {}

/** The scan whose neighbours are nearest to each other. The latest one stays, and the first of the
 *  drive. */
std::size_t ScanFeed::leastMissed() const {
    std::size_t least = 0;
    double leastGap_s = std::numeric_limits<double>::infinity();
    for (std::size_t i = taken_s_ ? 0 : 1; i + 1 < waiting_.size(); ++i) {
        const double before_s = i == 0 ? *taken_s_ : waiting_[i - 1].scan.stamp_s,
                     gap_s = waiting_[i + 1].scan.stamp_s - before_s;
        if (gap_s >= leastGap_s) continue;
        least = i;
        leastGap_s = gap_s;
    }
    return least;
}

/** Its samples go to the next scan. */
void ScanFeed::drop(std::size_t item) {
    Item& next = waiting_[item + 1];
    next.scan.dropped += waiting_[item].scan.dropped + 1;
    passOn(std::move(waiting_[item].imu), next.imu);
    passOn(std::move(waiting_[item].odometry), next.odometry);
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(item));
    ++dropped_;
}

/** Passes over the oldest. */
void ScanFeed::catchUp() {
    constexpr std::size_t kPart = 4;
    const std::size_t over = isLate_ && taken_s_ ? waiting_.size() / kPart : 0;
    for (std::size_t i = 0; i < over; ++i) drop(0);
    isLate_ = isLate_ && over > 0;
}

void ScanFeed::add(Scan scan, std::optional<double> received_s) {
    bool isFirst = false;
    {
        const std::lock_guard lock(mutex_);
        if (closed_) return;
        waiting_.push_back(
            {std::move(scan), std::exchange(imu_, {}), std::exchange(odometry_, {}), received_s});
        if (waiting_.size() > mostWaiting_) {
            isFirst = dropped_ == 0;
            isLate_ = true;
            drop(leastMissed());
        }
        changed_.notify_one();
    }
    if (isFirst && onFirstDrop_) onFirstDrop_();
}

void ScanFeed::add(const ImuSample& sample) {
    const std::lock_guard lock(mutex_);
    if (!closed_) appendBounded(imu_, {sample});
}

void ScanFeed::add(const OdometrySample& sample) {
    const std::lock_guard lock(mutex_);
    if (!closed_) appendBounded(odometry_, {sample});
}

void ScanFeed::close() { close(nullptr); }

void ScanFeed::close(std::exception_ptr fault) {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    closed_ = true;
    fault_ = std::move(fault);
    changed_.notify_all();
}

std::optional<ScanFeed::Item> ScanFeed::take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
    if (waiting_.empty()) {
        if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
        return {};
    }
    catchUp();
    Item item = std::move(waiting_.front());
    waiting_.pop_front();
    taken_s_ = item.scan.stamp_s;
    return item;
}

std::size_t ScanFeed::dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
}
}  // namespace delio::io
