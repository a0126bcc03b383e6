#include "odometry/arrivals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "delio/core/geometry.h"
#include "odometry/spin_axis.h"

namespace delio::odometry {
namespace {
/** Mixes the bits of `value` into `hash` (the finaliser of MurmurHash3). */
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
    hash = (hash ^ value) * 0xff51afd7ed558ccdULL;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    return hash ^ (hash >> 33);
}

/** Hash of the coordinates of about a thousand points. The noise of a new measurement changes every
 *  point. 0 for a scan of few points, which may be the same by chance. */
std::uint64_t fingerprintOf(const mrpt::maps::CPointsMap& points) {
    constexpr std::size_t kPoints = 1000, kFewest = 50;
    const std::size_t count = points.size();
    if (count < kFewest) return 0;
    std::uint64_t hash = mixed(1, count);
    for (const auto* coordinates : {&points.getPointsBufferRef_x(), &points.getPointsBufferRef_y(),
                                    &points.getPointsBufferRef_z()})
        for (std::size_t i = 0; i < count; i += 1 + count / kPoints) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, coordinates->data() + i, sizeof(bits));
            hash = mixed(hash, bits);
        }
    return hash;
}

/** How long the sensor takes for a turn, seconds; 0 where it does not spin. */
double periodOf(const Scan& scan) {
    Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(scan.times_s.size()));
    std::vector<float> times_s;
    for (std::size_t i = 0; i < scan.times_s.size(); ++i) {
        const Eigen::Vector3f point(scan.points->getPointsBufferRef_x()[i],
                                    scan.points->getPointsBufferRef_y()[i],
                                    scan.points->getPointsBufferRef_z()[i]);
        if (!point.allFinite() || point.isZero() || !std::isfinite(scan.times_s[i])) continue;
        points.col(static_cast<Eigen::Index>(times_s.size())) = point;
        times_s.push_back(scan.times_s[i]);
    }
    points.conservativeResize(3, static_cast<Eigen::Index>(times_s.size()));
    return turnPeriodOf(points, times_s).value_or(0);
}

/** From the first to the last time of a point, seconds; 0 where they are not known. */
double spanOf(const std::vector<float>& times_s) {
    float least = 0, most = 0;
    bool isFirst = true;
    for (const float time_s : times_s) {
        if (!std::isfinite(time_s)) continue;
        least = isFirst ? time_s : std::min(least, time_s);
        most = isFirst ? time_s : std::max(most, time_s);
        isFirst = false;
    }
    return double{most} - double{least};
}
}  // namespace

bool TurnClock::isUneven(const Scan& scan, double interval_s) {
    constexpr double kUneven = 0.05, kShortest = 0.2, kLongest = 1.8;
    constexpr double kLeast = 0.6, kMost = 1.2;  // of a turn
    const auto differs = [&](double turn_s) {
        return interval_s > kShortest * turn_s && interval_s < kLongest * turn_s &&
               std::abs(interval_s - turn_s) > kUneven * turn_s;
    };
    const double span_s = spanOf(scan.times_s);
    if (span_s <= 0 || !differs(span_s)) return false;
    if (!period_s_) period_s_ = periodOf(scan);
    // Parts of a turn, or several turns in one scan, do not follow each other turn by turn.
    const double turn_s = *period_s_;
    return differs(turn_s) && span_s > kLeast * turn_s && span_s < kMost * turn_s;
}

/** The evened stamp, from the one before. */
double TurnClock::follow(double stamp_s, double interval_s) {
    constexpr double kGain = 0.2, kShortest = 0.2, kMostTurns = 5;
    constexpr double kMissing = 0.6;  // turns late: a scan is missing, else the stamp jitters
    const double turn_s = *period_s_, passed = (stamp_s - even_s_) / turn_s,
                 turns = std::max(1.0, std::floor(passed + 1 - kMissing)),
                 expected_s = even_s_ + turns * turn_s, off_s = stamp_s - expected_s;
    const bool isShort = interval_s >= 0 && interval_s < kShortest * turn_s;
    if (isShort && passed < kMissing) return even_s_ + interval_s;
    if (interval_s < 0 || turns > kMostTurns) {
        state_ = State::kRaw;
        return stamp_s;
    }
    if (off_s < -turn_s) {  // scans come more often than the sensor turns
        state_ = State::kOff;
        return stamp_s;
    }
    return expected_s + kGain * off_s;
}

double TurnClock::correction_s(const Scan& scan) {
    const double stamp_s = scan.stamp_s, interval_s = stamp_s - raw_s_;
    if (state_ == State::kOff || scan.times_s.empty() || !std::isfinite(stamp_s)) return 0;
    if (state_ == State::kRaw && isUneven(scan, interval_s)) state_ = State::kEvened;
    if (state_ == State::kNoStamp) state_ = State::kRaw;
    even_s_ = state_ == State::kEvened ? follow(stamp_s, interval_s) : stamp_s;
    raw_s_ = stamp_s;
    return even_s_ - stamp_s;
}

Arrival Arrivals::take(const Scan& scan, double time_s) {
    const std::uint64_t fingerprint = fingerprintOf(*scan.points);
    copies_ = fingerprint != 0 && fingerprint == fingerprint_ ? copies_ + 1 : 0;
    fingerprint_ = fingerprint;
    const double evened_s = copies_ > 0 ? time_s : time_s + clock_.correction_s(scan);
    const Interval interval = timeline_.advance(evened_s, copies_ > 0);
    const bool hasTimes = !scan.times_s.empty(), isEmpty = scan.points->empty();
    hadTimes_ = hadTimes_ || hasTimes;
    if (!isEmpty) untimed_ = needTimes_ && hadTimes_ && !hasTimes ? untimed_ + 1 : 0;
    return {interval, evened_s, copies_, untimed_};
}

std::string reasonToSkip(const Arrival& arrival, const LinearPrediction& prediction) {
    if (arrival.interval.kind == IntervalKind::kShort) return "too soon after the scan before it";
    constexpr unsigned kPatience = 3;
    if (arrival.untimed > 0 && arrival.untimed <= kPatience) return "points without times";
    if (arrival.copies == 0) return {};
    constexpr const char* kCopy = "copy of the scan before it";
    if (!prediction.hasMotion()) return arrival.copies == 1 ? kCopy : "";
    // Slower than this, a copy that is taken for a measurement does no harm.
    constexpr double kSlow_m = 0.1, kSlow_rad = 0.5 * M_PI / 180;
    const Eigen::Isometry3d motion = prediction.predict(arrival.interval.duration_s);
    const bool isSlow =
        motion.translation().norm() < kSlow_m && angleOf(motion.linear()) < kSlow_rad;
    return isSlow ? "" : kCopy;
}
}  // namespace delio::odometry
