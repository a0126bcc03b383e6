#include "scanner.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>

namespace delio::synth {
namespace {
constexpr std::uint64_t kPhaseKey = 0x9A5E, kRayKey = 0x4A1, kGainKey = 0x6A1;
}

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

void Scanner::scanRing(const Eigen::Isometry3d& lidarToWorld, std::size_t scan, std::size_t ring,
                       std::vector<float>& xyzi) const {
    // The head turns freely: no two scans have their rays at the same azimuths. Each laser has its
    // own small offset.
    const double phase =
        Random{seed_, kPhaseKey, scan}.uniform() * 0.5 + Random{kPhaseKey, ring}.uniform() * 0.5;
    const double gain = Random{kGainKey, ring}.uniform(0.8, 1.2);  // lasers are not all alike
    const double elevation = sensor_.elevations_rad[ring];
    const double level = std::cos(elevation), up = std::sin(elevation);
    const auto columns = static_cast<std::size_t>(sensor_.columns);
    const auto azimuthOf = [&](std::size_t c) {
        return 2 * 3.14159265358979323846 * (static_cast<double>(c) + phase) /
               static_cast<double>(columns);
    };
    std::vector<Eigen::Vector3d> local(columns), world(columns);
    for (std::size_t c = 0; c < columns; ++c) {
        const double azimuth = azimuthOf(c);
        local[c] = {level * std::cos(azimuth), level * std::sin(azimuth), up};
        world[c] = lidarToWorld.linear() * local[c];
    }
    std::vector<Hit> hits;
    caster_.cast(lidarToWorld.translation(), world, sensor_.maxRange_m, hits);
    for (std::size_t c = 0; c < columns; ++c) {
        const Hit& hit = hits[c];
        if (hit.range <= 0 || behindOwnVehicle(azimuthOf(c), elevation)) continue;
        Random random{seed_, kRayKey, scan, ring, c};
        if (!random.chance(detectionProbability(hit))) continue;
        const double range = hit.range + noise_m_ * random.normal();
        if (range < sensor_.minRange_m || range > sensor_.maxRange_m) continue;
        for (int k = 0; k < 3; ++k) xyzi.push_back(static_cast<float>(range * local[c][k]));
        xyzi.push_back(intensity(hit, gain, random));
    }
}

std::vector<float> Scanner::scan(const Eigen::Isometry3d& lidarToWorld, std::size_t scan) const {
    std::vector<std::vector<float>> rings(sensor_.elevations_rad.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t ring = next++; ring < rings.size(); ring = next++)
            scanRing(lidarToWorld, scan, ring, rings[ring]);
    };
    // Not TBB: Embree's fixed building thread limits TBB in the whole process.
    std::vector<std::future<void>> others;
    const auto threads = std::min(static_cast<std::size_t>(threads_), rings.size());
    for (std::size_t i = 1; i < threads; ++i)
        others.push_back(std::async(std::launch::async, work));
    work();
    for (auto& other : others) other.get();
    std::vector<float> all;
    for (const auto& ring : rings) all.insert(all.end(), ring.begin(), ring.end());
    return all;
}
}  // namespace delio::synth
