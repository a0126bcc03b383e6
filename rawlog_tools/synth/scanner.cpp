#include "scanner.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>

namespace delio::synth {
namespace {
constexpr std::uint64_t kOffsetKey = 0x9A5E, kRayKey = 0x4A1, kGainKey = 0x6A1, kBiasKey = 0xB1A5;

void append(ScanPoints& all, const ScanPoints& more) {
    all.xyzi.insert(all.xyzi.end(), more.xyzi.begin(), more.xyzi.end());
    all.time_s.insert(all.time_s.end(), more.time_s.begin(), more.time_s.end());
    all.ring.insert(all.ring.end(), more.ring.begin(), more.ring.end());
    all.label.insert(all.label.end(), more.label.begin(), more.label.end());
}
}  // namespace

double detectionProbability(const Hit& hit) {
    // The echo's strength, 1 for a white wall at 100 m: road is lost from 50 m on, as in real
    // scans. Panes and dark paint mirror most of the light away unless hit head-on.
    const double mirror = hit.reflectivity < 0.1 ? std::pow(hit.cosIncidence, 4) : 1;
    const double strength =
        hit.reflectivity * hit.cosIncidence * (100 / hit.range) * (100 / hit.range);
    return 0.985 * mirror * (1 - std::exp(-strength / 0.04));
}

float intensity(const Hit& hit, double gain, Random& random) {
    const double value =
        gain * hit.reflectivity * (0.8 + 0.4 * hit.cosIncidence) + 0.03 * random.normal();
    return static_cast<float>(std::round(100 * std::clamp(value, 0.0, 0.99)) / 100);
}

bool behindOwnVehicle(double azimuth, double elevation) {
    const double fromAxis = std::abs(std::sin(azimuth));
    const bool front = std::cos(azimuth) > 0;
    return fromAxis < (front ? 0.4 : 0.3) && elevation < (front ? -0.36 : -0.34);
}

Scanner::Scanner(const RayCaster& caster, const TrafficCaster* traffic, SensorModel sensor,
                 const ScannerOptions& options)
    : caster_(caster), traffic_(traffic), sensor_(std::move(sensor)), options_(options) {}

ScanPoints Scanner::scanRing(const Sweep& sweep, const Views& views, std::size_t scan,
                             std::size_t ring) const {
    // Lasers are not all alike: each looks a little beside its column, and has its own gain.
    const double turn = 2 * 3.14159265358979323846;
    const double offset = Random{kOffsetKey, ring}.uniform() * 0.5 * turn / sensor_.columns;
    const double gain = Random{kGainKey, ring}.uniform(0.8, 1.2);
    const double bias = options_.ringBias_m * Random{options_.seed, kBiasKey, ring}.normal();
    const double elevation = sensor_.elevations_rad[ring];
    const double level = std::cos(elevation), up = std::sin(elevation);
    const std::size_t columns = sweep.azimuth_rad.size();
    std::vector<Eigen::Vector3d> local(columns);
    std::vector<Ray> rays(columns);
    for (std::size_t c = 0; c < columns; ++c) {
        const double azimuth = sweep.azimuth_rad[c] + offset;
        local[c] = {level * std::cos(azimuth), level * std::sin(azimuth), up};
        rays[c] = {sweep.lidarToWorld[c].translation(), sweep.lidarToWorld[c].linear() * local[c]};
    }
    std::vector<Hit> hits;
    caster_.cast(rays, sensor_.maxRange_m, hits);
    for (const auto& view : views) traffic_->cast(view, local, hits);
    ScanPoints points;
    for (std::size_t c = 0; c < columns; ++c) {
        const Hit& hit = hits[c];
        if (hit.range <= 0 || behindOwnVehicle(sweep.azimuth_rad[c], elevation)) continue;
        Random random{options_.seed, kRayKey, scan, ring, c};
        if (!random.chance(detectionProbability(hit))) continue;
        const double range = hit.range + bias + options_.noise_m * random.normal();
        if (range < sensor_.minRange_m || range > sensor_.maxRange_m) continue;
        for (int k = 0; k < 3; ++k) points.xyzi.push_back(static_cast<float>(range * local[c][k]));
        points.xyzi.push_back(intensity(hit, gain, random));
        points.time_s.push_back(static_cast<float>(sweep.time_s[c]));
        points.ring.push_back(static_cast<std::uint16_t>(ring));
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
