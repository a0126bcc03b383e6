#include "recognised_reader.h"

#include <algorithm>
#include <utility>

#include "compensation.h"

namespace delio::io {
namespace {
/** Each point has its time, and turns come in order. */
bool arePackets(Delivery delivery) {
    return delivery == Delivery::kPackets || delivery == Delivery::kSensor;
}
}  // namespace

RecognisedReader::RecognisedReader(std::unique_ptr<ScanReader> source, Delivery delivery)
    : source_(std::move(source)),
      delivery_(delivery),
      fraction_(source_->fraction()),
      order_(arePackets(delivery)) {
    readAhead();
    recognise();
}

/** Reads the next scan of the source into `ahead_`; false at the end. */
bool RecognisedReader::readOne() {
    if (ended_) return false;
    try {
        if (auto scan = source_->next()) {
            ahead_.push_back(std::move(*scan));
            dropUnfitTimes(ahead_.back());
            fractions_.push_back(source_->fraction());
            return true;
        }
    } catch (const std::exception&) {
        fault_ = std::current_exception();
    }
    ended_ = true;
    return false;
}

/** De-skewing by times that do not belong to the points would do more harm than none. */
void RecognisedReader::dropUnfitTimes(Scan& scan) {
    if (scan.times_s.size() != scan.points->size() || timesFitDirections(scan)) return;
    scan.times_s.clear();
    findings_.add("point times contradict the azimuths: not used", scan.index);
}

/** Empty scans identify nothing. */
void RecognisedReader::readAhead() {
    constexpr std::size_t kMost = 20;
    const std::size_t scans = delivery_ == Delivery::kSensor ? 1 : 3;
    std::size_t withPoints = 0;
    while (withPoints < scans && ahead_.size() < kMost && readOne())
        withPoints += !ahead_.back().points->empty();
}

void RecognisedReader::recognise() {
    recording_ = source_->recording();
    meta_ = source_->meta();
    if (ahead_.empty()) return;
    recording_.startsEmpty = true;
    for (const auto& scan : ahead_) {
        recording_.startsEmpty = recording_.startsEmpty && scan.points->empty();
        recording_.pointTimes = recording_.pointTimes || !scan.times_s.empty();
    }
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

Recording RecognisedReader::recording() const {
    Recording recording = recording_;
    recording.findings = source_->recording().findings;
    for (const auto& lines : {findings_.lines(), order_.findings()})
        recording.findings.insert(recording.findings.end(), lines.begin(), lines.end());
    return recording;
}

/** The map begins with the first scan. One without times, where the next ones have them, would bend
 *  it. */
void RecognisedReader::leaveOutFirst() {
    constexpr std::size_t kFew = 100;  // points: such a scan is not used in any case
    if (recording_.motionCompensated.value_or(false) || arePackets(delivery_)) return;
    const auto isUntimed = [](const Scan& scan) {
        return scan.times_s.empty() && scan.points->size() >= kFew;
    };
    const auto first = std::find_if_not(ahead_.begin(), ahead_.end(), isUntimed);
    if (first == ahead_.end() || first->times_s.empty()) return;
    for (; isUntimed(ahead_.front()); ahead_.pop_front())
        findings_.add("first scans without point times, unlike the later ones: ignored",
                      ahead_.front().index);
}

/** Scans were taken off `ahead_`. */
void RecognisedReader::passed() {
    for (; fractions_.size() > ahead_.size(); fractions_.pop_front())
        fraction_ = fractions_.front();
    if (ahead_.empty()) fraction_ = source_->fraction();
}

/** What comes later does not matter. Samples of an IMU come with the scans that are read: as many
 *  from packets that are measured as from those that are recorded, and from a pipe as from a file.
 *  With the next turn those have come that are up to 0.1 s late. */
bool RecognisedReader::isNextKnown() const {
    if (delivery_ == Delivery::kFile || ahead_.empty() || !order_.isNext(ahead_.front()))
        return false;
    if (source_->recording().imu.empty()) return true;
    return arePackets(delivery_) && ahead_.size() > 1;
}

std::optional<Scan> RecognisedReader::next() {
    std::optional<Scan> scan;
    while (!scan) {
        while (!isNextKnown() && ahead_.size() < StampOrder::kWindow && readOne()) continue;
        if (!std::exchange(began_, true)) leaveOutFirst();
        if (fault_ && ahead_.empty()) std::rethrow_exception(std::exchange(fault_, nullptr));
        if (ahead_.empty()) return {};
        scan = order_.take(ahead_);
        passed();
    }
    lookAgain(*scan);
    return scan;
}

bool RecognisedReader::skip() {
    if (!ahead_.empty()) {
        ahead_.pop_front();
        passed();
        return true;
    }
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
    const bool skipped = !ended_ && source_->skip();
    passed();
    return skipped;
}

void RecognisedReader::lookAgain(const Scan& scan) {
    constexpr std::size_t kEvery = 20;
    if (scan.index % kEvery != 0 || !recording_.compensationMeasured ||
        *recording_.motionCompensated || recording_.compensatedAfterAll)
        return;
    if (isMotionCompensated(scan).value_or(false)) recording_.compensatedAfterAll = scan.index;
}
}  // namespace delio::io
