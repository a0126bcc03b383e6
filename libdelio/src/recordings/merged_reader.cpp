#include "merged_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "delio/core/error.h"
#include "scan_points.h"

namespace delio::io {
namespace {
constexpr double kSameTime_s = 0.005;
constexpr std::size_t kFewScans = 5;  // without points of a sensor are not worth a line
constexpr double kPause = 1.5;        // intervals to the next scan: one is missing
constexpr double kLead = 0.75;        // intervals by which another sensor may be ahead

bool isTimed(const Scan& scan) { return !scan.times_s.empty(); }

/** Time of its first point, or its stamp. */
double beginOf(const Scan& scan) {
    double first_s = 0;
    bool any = false;
    for (const float time_s : scan.times_s) {
        if (!std::isfinite(time_s)) continue;
        first_s = any ? std::min<double>(first_s, time_s) : time_s;
        any = true;
    }
    return scan.stamp_s + first_s;
}

std::string listed(const std::set<std::string>& names) {
    std::string text;
    for (const auto& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
    return text;
}
}  // namespace

MergedReader::MergedReader(std::vector<MergedSensor> sensors, const ExtrinsicsFile& extrinsics)
    : imu_(extrinsics.imu) {
    for (auto& [label, reader] : sensors) {
        sensors_.emplace_back();
        sensors_.back().label = label;
        sensors_.back().reader = std::move(reader);
    }
    for (Sensor& sensor : sensors_) {
        fill(sensor);
        if (sensor.ahead.empty() && fault_) std::rethrow_exception(fault_);
        const auto& others = sensor.reader->otherLabels();
        if (sensor.ahead.empty())
            throw Error("no scans of the sensor '" + sensor.label + "'" +
                        (others.empty() ? "" : ", only of " + listed(others)));
        if (sensor.label.empty()) sensor.label = sensor.reader->label();
        label_ += (label_.empty() ? "" : ",") + sensor.label;
        if (sensor.ahead.size() > 1 && interval_s_ == 0)
            interval_s_ = sensor.ahead[1].stamp_s - sensor.ahead[0].stamp_s;
    }
    others_ = sensors_.front().reader->otherLabels();
    for (const Sensor& sensor : sensors_) others_.erase(sensor.reader->label());
    takePoses(extrinsics.lidars);
}

std::vector<ImuSample> MergedReader::takeImu() {
    auto samples = sensors_.front().reader->takeImu();
    if (imu_)
        for (ImuSample& sample : samples) {
            sample.sensorPose = imu_->pose;
            sample.offset_s = imu_->offset_s;
        }
    return samples;
}

void MergedReader::takePoses(const Extrinsics& poses) {
    std::string root;
    for (Sensor& sensor : sensors_) {
        const auto& name = sensor.reader->label();
        const auto pose =
            poses.count(sensor.label) > 0 ? poses.find(sensor.label) : poses.find(name);
        if (!poses.empty() && pose == poses.end())
            throw Error("the extrinsics have no pose of the sensor '" + name + "'");
        if (pose != poses.end()) sensor.pose = pose->second;
        if (!poses.empty() || sensors_.size() == 1) continue;
        const auto mount = sensor.reader->mount();
        if (!mount) continue;  // its scans say it
        if (&sensor == &sensors_.front()) root = mount->frame;
        if (mount->frame != root)
            throw Error("/tf_static does not connect the sensors '" + sensors_.front().label +
                        "' and '" + sensor.label + "'; give their poses with --extrinsics FILE");
        sensor.pose = mount->pose;
    }
    const Scan& first = sensors_.front().ahead.front();
    reference_ = poseOf(sensors_.front(), first);
    vehiclePose_ = poses.empty() ? first.sensorPose : reference_;
    for (const Sensor& sensor : sensors_)
        poses_.emplace_back(sensor.label, poseOf(sensor, sensor.ahead.front()));
    if (poses.empty())
        for (const Sensor& sensor : sensors_)
            if (&sensor != &sensors_.front() &&
                poseOf(sensor, sensor.ahead.front()).isApprox(reference_, 1e-9))
                warnings_.push_back("the sensors '" + sensors_.front().label + "' and '" +
                                    sensor.label +
                                    "' have the same pose in the recording; if that is wrong, give "
                                    "their poses with --extrinsics FILE");
}

Eigen::Isometry3d MergedReader::poseOf(const Sensor& sensor, const Scan& scan) const {
    return sensor.pose.value_or(scan.sensorPose);
}

void MergedReader::fill(Sensor& sensor) {
    constexpr std::size_t kAhead = 2;
    try {
        while (!sensor.ended && sensor.ahead.size() < kAhead) {
            auto scan = sensor.reader->next();
            sensor.ended = !scan;
            if (scan) sensor.ahead.push_back(std::move(*scan));
        }
    } catch (const std::exception&) {
        sensor.ended = true;
        if (!fault_) fault_ = std::current_exception();
    }
}

/** The sensor whose scan comes next: the first in order whose scan is not far behind the others.
 *  What was left of a scan does not set an interval. */
MergedReader::Sensor* MergedReader::driver() {
    double first_s = INFINITY;
    for (Sensor& sensor : sensors_) {
        fill(sensor);
        if (!sensor.ahead.empty() && !sensor.isRest)
            first_s = std::min(first_s, sensor.ahead.front().stamp_s);
    }
    for (Sensor& sensor : sensors_)
        if (!sensor.ahead.empty() && !sensor.isRest &&
            (interval_s_ <= 0 || sensor.ahead.front().stamp_s <= first_s + kLead * interval_s_))
            return &sensor;
    bool isLeft = false;
    for (Sensor& sensor : sensors_) {
        if (!std::exchange(sensor.isRest, false)) continue;
        sensor.ahead.pop_front();
        isLeft = true;
    }
    return isLeft ? driver() : nullptr;
}

MergedReader::Interval MergedReader::intervalOf(const Sensor& driver) const {
    const double begin_s = beginOf(driver.ahead.front());
    const double usual_s = interval_s_ > 0 ? begin_s + interval_s_ : INFINITY;
    if (driver.ahead.size() < 2) return {begin_s, usual_s, false};
    const double next_s = beginOf(driver.ahead[1]);
    const bool pauses = interval_s_ > 0 && next_s > begin_s + kPause * interval_s_;
    return {begin_s, pauses ? usual_s : next_s, !pauses};
}

/** Appends the points for which `isWanted(i)`, in the first sensor's frame. */
template <typename IsWanted>
void MergedReader::append(const Scan& scan, const Sensor& sensor, Scan& merged,
                          const IsWanted& isWanted) {
    const Eigen::Isometry3d pose =
        &sensor == &sensors_.front()
            ? Eigen::Isometry3d::Identity()
            : Eigen::Isometry3d(reference_.inverse() * poseOf(sensor, scan));
    const std::size_t before = merged.points->size();
    const bool numbered = merged.rings.size() == before && !scan.rings.empty();
    const bool timed = !merged.times_s.empty() || (before == 0 && isTimed(scan));
    std::uint16_t firstRing = 0;
    for (const auto ring : merged.rings) firstRing = std::max<std::uint16_t>(firstRing, ring + 1);
    const double later_s = scan.stamp_s - merged.stamp_s;
    for (std::size_t i = 0; i < scan.points->size(); ++i) {
        if (!isWanted(i)) continue;
        addPoint(*scan.points, i, pose, *merged.points);
        if (numbered) merged.rings.push_back(static_cast<std::uint16_t>(firstRing + scan.rings[i]));
        if (timed)
            merged.times_s.push_back(
                static_cast<float>(later_s + (isTimed(scan) ? scan.times_s[i] : 0.0F)));
    }
    if (!numbered && merged.points->size() > before) merged.rings.clear();
}

std::optional<Scan> MergedReader::next() {
    Sensor* const leader = driver();
    if (!leader) {
        if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
        return {};
    }
    const Interval interval = intervalOf(*leader);
    const Scan own = std::move(leader->ahead.front());
    leader->ahead.pop_front();
    const bool isFirst = leader == &sensors_.front();
    if (isFirst)
        learnInterval(own.stamp_s);
    else
        ++replaced_;
    Scan merged = own;
    merged.index = isFirst ? own.index + replaced_ : count_;
    merged.sensorPose = vehiclePose_;
    if (sensors_.size() > 1) {
        merged.points = emptyLike(*own.points);
        merged.rings.clear();
        merged.times_s.clear();
        append(own, *leader, merged, [](std::size_t) { return true; });
    }
    note(*leader, merged.index);
    // Those before it in order set the next interval where they have a scan.
    for (Sensor& sensor : sensors_)
        if (&sensor > leader) take(sensor, own, interval, merged);
    count_ = merged.index + 1;
    return merged;
}

void MergedReader::learnInterval(double stamp_s) {
    constexpr std::size_t kMost = 9;
    if (latestStamp_s_ && stamp_s > *latestStamp_s_)
        intervals_s_.push_back(stamp_s - *latestStamp_s_);
    latestStamp_s_ = stamp_s;
    if (intervals_s_.size() > kMost) intervals_s_.pop_front();
    if (intervals_s_.empty()) return;
    auto sorted = intervals_s_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    interval_s_ = *middle;
}

/** Appends what the sensor has in the interval, which the scan `own` of another one sets. */
void MergedReader::take(Sensor& sensor, const Scan& own, const Interval& interval, Scan& merged) {
    while (!sensor.ahead.empty()) {
        const Scan scan = sensor.ahead.front();
        const bool cut = (interval.cuts || sensor.isRest) && isTimed(scan) && isTimed(own);
        const double half_s =
            (std::isfinite(interval.end_s) ? interval.end_s - interval.begin_s : INFINITY) / 2;
        if (cut ? beginOf(scan) >= interval.end_s : scan.stamp_s >= own.stamp_s + half_s) return;
        const auto timeOf = [&](std::size_t i) {
            return cut ? scan.stamp_s + scan.times_s[i] : scan.stamp_s;
        };
        const double oldest_s = (cut ? interval.begin_s : own.stamp_s) - half_s;
        const double end_s = cut ? interval.end_s : INFINITY;
        const std::size_t before = merged.points->size();
        append(scan, sensor, merged,
               [&](std::size_t i) { return !(timeOf(i) < oldest_s) && !(timeOf(i) >= end_s); });
        if (merged.points->size() > before) note(sensor, merged.index);
        sensor.ahead.pop_front();
        sensor.isRest = false;
        if (cut) {
            Scan rest = partOf(scan, [&](std::size_t i) { return timeOf(i) >= end_s; });
            sensor.isRest = !rest.points->empty();
            if (sensor.isRest) sensor.ahead.push_front(std::move(rest));
            if (sensor.isRest) return;
        } else if (!isTimed(own) && std::abs(scan.stamp_s - own.stamp_s) > kSameTime_s) {
            findings_.add("scans of the sensor '" + sensor.label +
                              "' were merged as if measured at once with those of another sensor, "
                              "although their stamps differ by more than 5 ms: no point times",
                          merged.index);
        }
        fill(sensor);
    }
}

/** The sensor has points in the merged scan `scan`. */
void MergedReader::note(Sensor& sensor, std::size_t scan) {
    if (scan > sensor.seen + kFewScans)
        gaps_.push_back("the sensor '" + sensor.label + "' sent nothing from scan " +
                        std::to_string(sensor.seen) + " to scan " + std::to_string(scan - 1));
    sensor.seen = scan + 1;
}

std::optional<double> MergedReader::fraction() const {
    std::optional<double> least;
    for (const Sensor& sensor : sensors_)
        if (const auto fraction = sensor.reader->fraction())
            least = least ? std::min(*least, *fraction) : fraction;
    return least;
}

Recording MergedReader::recording() const {
    Recording recording = sensors_.front().reader->recording();
    if (sensors_.size() > 1) recording.kind += ", merged sensors " + label_;
    recording.warnings.insert(recording.warnings.end(), warnings_.begin(), warnings_.end());
    auto& findings = recording.findings;
    for (std::size_t i = 1; i < sensors_.size(); ++i) {
        const Recording other = sensors_[i].reader->recording();
        for (const auto& finding : other.findings)
            findings.push_back("sensor '" + sensors_[i].label + "': " + finding);
        if (other.motionCompensated != recording.motionCompensated)
            recording.warnings.push_back(
                "only one of the sensors '" + sensors_.front().label + "' and '" +
                sensors_[i].label +
                "' is de-skewed by the recorder; both are processed as the first one");
    }
    for (const auto& lines : {findings_.lines(), gaps_})
        findings.insert(findings.end(), lines.begin(), lines.end());
    for (const Sensor& sensor : sensors_)
        if (count_ > sensor.seen + kFewScans)
            findings.push_back("the sensor '" + sensor.label + "' sent nothing from scan " +
                               std::to_string(sensor.seen) + " on");
    return recording;
}
}  // namespace delio::io
