#include "road.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;

/** Crossfall of 2 %, a kerb of 13 cm, a sidewalk that falls towards it, then level. */
double crossSection(double side) {
    const double away = std::abs(side);
    if (away <= Road::kKerb_m) return -0.02 * away;
    const double sidewalk = std::min(away, Road::kSidewalkEnd_m) - Road::kKerb_m;
    return -0.02 * Road::kKerb_m + 0.13 + 0.015 * sidewalk;
}
}  // namespace

Road::Road(Path path, std::uint64_t seed) : path_(std::move(path)) {
    Random random{seed, 0x60D};
    // Hills, the settling of the road (2-4 cm), and what one feels in the seat.
    constexpr double amplitudes[] = {0.9, 0.6, 0.012, 0.010, 0.010, 0.003, 0.003, 0.002};
    constexpr double lengths[] = {380, 240, 27, 19, 13, 7, 5.5, 4};
    for (std::size_t i = 0; i < waves_.size(); ++i) {
        const double direction = random.uniform(0, 2 * kPi);
        const double number = 2 * kPi / (lengths[i] * random.uniform(0.9, 1.1));
        waves_[i] = {amplitudes[i],
                     number * Eigen::Vector2d(std::cos(direction), std::sin(direction)),
                     random.uniform(0, 2 * kPi)};
    }
}

Eigen::Vector2d Road::point(double s, double side_m) const {
    const Station at = path_.at(s);
    const double d = side_m - kVehicleOffset_m;
    return {at.x - d * std::sin(at.yaw), at.y + d * std::cos(at.yaw)};
}

double Road::distance(const Eigen::Vector2d& place, double s) const {
    double nearest = std::numeric_limits<double>::max();
    for (double along = s - 200; along <= s + 200; along += 2)
        nearest = std::min(nearest, (place - point(along, 0)).squaredNorm());
    return std::sqrt(nearest);
}

double Road::height(const Eigen::Vector2d& place, double side_m) const {
    double z = crossSection(side_m);
    for (const auto& wave : waves_)
        z += wave.amplitude * std::sin(wave.number.dot(place) + wave.phase);
    return z;
}
}  // namespace delio::synth
