#include "scanner.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>

#include "echo.h"

namespace delio::synth {
namespace {
constexpr std::uint64_t kOffsetKey = 0x9A5E, kRayKey = 0x4A1, kGainKey = 0x6A1, kBiasKey = 0xB1A5,
                        kPatchKey = 0xBA7C;
constexpr double kTurn = 2 * 3.14159265358979323846;

Eigen::Vector3d direction(double azimuth_rad, double elevation_rad) {
    const double level = std::cos(elevation_rad);
    return {level * std::cos(azimuth_rad), level * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

void append(ScanPoints& all, const ScanPoints& more) {
    all.xyzi.insert(all.xyzi.end(), more.xyzi.begin(), more.xyzi.end());
    all.time_s.insert(all.time_s.end(), more.time_s.begin(), more.time_s.end());
    all.ring.insert(all.ring.end(), more.ring.begin(), more.ring.end());
    all.label.insert(all.label.end(), more.label.begin(), more.label.end());
}
}  // namespace

Scanner::Scanner(const RayCaster& caster, const TrafficCaster* traffic, SensorModel sensor,
                 const ScannerOptions& options)
    : caster_(caster), traffic_(traffic), sensor_(std::move(sensor)), options_(options) {}

Scanner::Ring Scanner::makeRing(std::size_t number) const {
    Ring ring;
    ring.number = number;
    ring.elevation_rad = sensor_.elevations_rad[number];
    ring.offset_rad = Random{kOffsetKey, number}.uniform() * 0.5 * kTurn / sensor_.columns;
    ring.gain = Random{kGainKey, number}.uniform(0.8, 1.2);
    ring.bias_m = options_.ringBias_m * Random{options_.seed, kBiasKey, number}.normal();
    return ring;
}

void Scanner::cast(Ring& ring, const Sweep& sweep, const Views& views) const {
    std::vector<Eigen::Vector3d> local;
    std::vector<Ray> rays;
    local.reserve(sweep.azimuth_rad.size());
    rays.reserve(sweep.azimuth_rad.size());
    for (std::size_t c = 0; c < sweep.azimuth_rad.size(); ++c) {
        const auto& pose = sweep.lidarToWorld[c];
        local.push_back(direction(sweep.azimuth_rad[c] + ring.offset_rad, ring.elevation_rad));
        rays.push_back({pose.translation(), pose.linear() * local.back()});
    }
    caster_.cast(rays, sensor_.maxRange_m, ring.hits);
    for (const auto& view : views) traffic_->cast(view, local, ring.hits);
    castOwnBox(options_.own, local, ring.hits);
}

bool Scanner::isNoticed(const Ring& ring, std::size_t column, std::size_t scan,
                        Random& random) const {
    constexpr double kFired = 0.9985, kAlike = 0.8;
    constexpr std::size_t kPatch = 12;  // columns
    // What weakens an echo (a pane, wet paint) is mostly the same for the rays beside: neighbours
    // are lost together. A draw shared with them, or one's own: uniform either way.
    Random patch{options_.seed, kPatchKey, scan, ring.number, column / kPatch};
    const bool fired = random.chance(kFired), alike = random.chance(kAlike);
    const double own = random.uniform();
    return fired && (alike ? patch.uniform() : own) < detectionProbability(ring.hits[column]);
}

double Scanner::measuredRange(const Ring& ring, std::size_t column, Random& random) const {
    const double exact = ring.hits[column].range + ring.bias_m;
    if (options_.noise_m == 0) return exact;
    const Hit& next = ring.hits[(column + 1) % ring.hits.size()];
    const double share = mixedShare(ring.hits[column], next, random);
    return exact + share * (next.range - ring.hits[column].range) +
           options_.noise_m * random.normal();
}

double Scanner::reportedAzimuth(double azimuth_rad) const {
    const double step = sensor_.encoderStep_rad;
    if (options_.noise_m == 0 || step == 0) return azimuth_rad;
    return step * std::round(azimuth_rad / step);
}

ScanPoints Scanner::scanRing(const Sweep& sweep, const Views& views, std::size_t scan,
                             std::size_t number) const {
    Ring ring = makeRing(number);
    cast(ring, sweep, views);
    ScanPoints points;
    for (std::size_t c = 0; c < ring.hits.size(); ++c) {
        const Hit& hit = ring.hits[c];
        if (hit.range <= 0) continue;
        if (options_.onVehicle && behindOwnVehicle(sweep.azimuth_rad[c], ring.elevation_rad))
            continue;
        Random random{options_.seed, kRayKey, scan, number, c};
        if (!isNoticed(ring, c, scan, random)) continue;
        const double range = measuredRange(ring, c, random);
        if (range < sensor_.minRange_m || range > sensor_.maxRange_m) continue;
        const Eigen::Vector3d point =
            range *
            direction(reportedAzimuth(sweep.azimuth_rad[c]) + ring.offset_rad, ring.elevation_rad);
        for (const double value : point) points.xyzi.push_back(static_cast<float>(value));
        points.xyzi.push_back(intensity(hit, ring.gain, random));
        points.time_s.push_back(static_cast<float>(sweep.time_s[c]));
        points.ring.push_back(static_cast<std::uint16_t>(number));
        points.label.push_back(hit.moving ? 1 : 0);
    }
    return points;
}

ScanPoints Scanner::scan(const Sweep& sweep, std::size_t scan) const {
    const Views views = traffic_ ? traffic_->viewsOf(sweep, sensor_.maxRange_m) : Views{};
    std::vector<ScanPoints> rings(sensor_.elevations_rad.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t ring = next++; ring < rings.size(); ring = next++)
            rings[ring] = scanRing(sweep, views, scan, ring);
    };
    // Not TBB: Embree's fixed building thread limits TBB in the whole process.
    std::vector<std::future<void>> others;
    const auto threads = std::min(static_cast<std::size_t>(options_.threads), rings.size());
    for (std::size_t i = 1; i < threads; ++i)
        others.push_back(std::async(std::launch::async, work));
    work();
    for (auto& other : others) other.get();
    ScanPoints all;
    for (const auto& ring : rings) append(all, ring);
    return all;
}
}  // namespace delio::synth
