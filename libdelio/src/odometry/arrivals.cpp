#include "odometry/arrivals.h"

#include <cmath>
#include <cstring>

#include "delio/core/geometry.h"

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
}  // namespace

Arrival Arrivals::take(const Scan& scan, double time_s) {
    const std::uint64_t fingerprint = fingerprintOf(*scan.points);
    copies_ = fingerprint != 0 && fingerprint == fingerprint_ ? copies_ + 1 : 0;
    fingerprint_ = fingerprint;
    const Interval interval = timeline_.advance(time_s, copies_ > 0);
    const bool hasTimes = !scan.times_s.empty(), isEmpty = scan.points->size() == 0;
    hadTimes_ = hadTimes_ || hasTimes;
    if (!isEmpty) untimed_ = needTimes_ && hadTimes_ && !hasTimes ? untimed_ + 1 : 0;
    return {interval, copies_, untimed_};
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
