#include "recognised_reader.h"

#include <utility>

#include "compensation.h"

namespace delio::io {
RecognisedReader::RecognisedReader(std::unique_ptr<ScanReader> source)
    : source_(std::move(source)) {
    readAhead();
    recognise();
}

void RecognisedReader::readAhead() {
    constexpr std::size_t kScans = 3;
    try {
        while (ahead_.size() < kScans) {
            auto scan = source_->next();
            if (!scan) return;
            ahead_.push_back(std::move(*scan));
        }
    } catch (const std::exception&) {
        fault_ = std::current_exception();
    }
}

void RecognisedReader::recognise() {
    recording_ = source_->recording();
    meta_ = source_->meta();
    if (ahead_.empty()) return;
    recording_.pointTimes = !ahead_.front().times_s.empty();
    if (ahead_.size() > 1) {
        // The first scan of a stream is a part of a turn.
        const double period_s = ahead_.back().stamp_s - ahead_[ahead_.size() - 2].stamp_s;
        constexpr double kLongest_s = 10;
        if (period_s > 0 && period_s < kLongest_s) recording_.rate_hz = 1 / period_s;
    }
    if (recording_.motionCompensated) return;
    for (const auto& scan : ahead_) {
        const auto compensated = isMotionCompensated(scan);
        if (!compensated || recording_.motionCompensated.value_or(false)) continue;
        recording_.motionCompensated = compensated;
        recording_.compensationMeasured = true;
    }
    if (!recording_.motionCompensated || meta_) return;
    meta_.emplace();
    if (!recording_.sensor.empty()) meta_->sensorModel = recording_.sensor;
    meta_->motionCompensated = *recording_.motionCompensated;
}

std::optional<Scan> RecognisedReader::next() {
    std::optional<Scan> scan;
    if (!ahead_.empty()) {
        scan = std::move(ahead_.front());
        ahead_.pop_front();
        return scan;
    }
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    scan = source_->next();
    if (scan) lookAgain(*scan);
    return scan;
}

bool RecognisedReader::skip() {
    if (!ahead_.empty()) {
        ahead_.pop_front();
        return true;
    }
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    return source_->skip();
}

void RecognisedReader::lookAgain(const Scan& scan) {
    constexpr std::size_t kEvery = 20;
    if (scan.index % kEvery != 0 || !recording_.compensationMeasured ||
        *recording_.motionCompensated || recording_.compensatedAfterAll)
        return;
    if (isMotionCompensated(scan).value_or(false)) recording_.compensatedAfterAll = scan.index;
}
}  // namespace delio::io
