#include "delio/recordings/scan_feed.h"

#include <algorithm>
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

void ScanFeed::add(Scan scan, std::optional<double> received_s) {
    bool isFirst = false;
    {
        const std::lock_guard lock(mutex_);
        if (closed_) return;
        waiting_.push_back(
            {std::move(scan), std::exchange(imu_, {}), std::exchange(odometry_, {}), received_s});
        if (waiting_.size() > mostWaiting_) {
            Item dropped = std::move(waiting_.front());
            waiting_.pop_front();
            passOn(std::move(dropped.imu), waiting_.front().imu);
            passOn(std::move(dropped.odometry), waiting_.front().odometry);
            isFirst = dropped_++ == 0;
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
    Item item = std::move(waiting_.front());
    waiting_.pop_front();
    return item;
}

std::size_t ScanFeed::dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
}
}  // namespace delio::io
