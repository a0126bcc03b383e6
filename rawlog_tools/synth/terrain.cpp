#include "terrain.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kHillKey = 0x60D, kBankKey = 0xBA2, kRoughKey = 0x20F;

double smoothStep(double from, double to, double x) {
    const double u = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return u * u * (3 - 2 * u);
}
}  // namespace

Terrain::Terrain(const RoadProfile& profile, std::uint64_t seed)
    : seed_(seed),
      grade_(profile.grade),
      half_m_(profile.half_m),
      bank_m_(profile.bank_m),
      bankFrom_m_(profile.bankFrom_m),
      bankTo_m_(profile.bankTo_m),
      roughness_m_(profile.roughness_m),
      ramps_(profile.ramps) {
    const auto wave = [](double amplitude, double length, Random& random) {
        const double direction = random.uniform(0, 2 * kPi);
        const double number = 2 * kPi / (length * random.uniform(0.9, 1.1));
        return Wave{amplitude, number * Eigen::Vector2d(std::cos(direction), std::sin(direction)),
                    random.uniform(0, 2 * kPi)};
    };
    Random hills{seed, kHillKey};
    for (const auto& w : profile.waves) waves_.push_back(wave(w.amplitude_m, w.length_m, hills));
    Random banks{seed, kBankKey};
    for (const double length : {150.0, 83.0, 47.0}) banks_.push_back(wave(0.5, length, banks));
}

double Terrain::height(const Eigen::Vector2d& place) const {
    double z = grade_ * place.x();
    for (const auto& w : waves_) z += w.amplitude * std::sin(w.number.dot(place) + w.phase);
    for (const auto& r : ramps_)
        z += r.rise_m * std::clamp((place.x() - r.fromX_m) / (r.toX_m - r.fromX_m), 0.0, 1.0);
    return z;
}

double Terrain::besideRoad(const Eigen::Vector2d& place, double away_m) const {
    if (away_m <= half_m_ && away_m <= bankFrom_m_) return 0;
    double bank = 0.35;  // cuttings are higher than embankments
    for (const auto& w : banks_) bank += w.amplitude * std::sin(w.number.dot(place) + w.phase);
    return bank_m_ * bank * smoothStep(bankFrom_m_, bankTo_m_, away_m) +
           roughness_m_ * smoothStep(half_m_ - 2, half_m_ + 1, away_m) * roughness(place);
}

double Terrain::roughness(const Eigen::Vector2d& place) const {
    if (roughness_m_ == 0) return 0;
    constexpr double kClod_m = 0.4;
    const double x = place.x() / kClod_m, y = place.y() / kClod_m;
    const auto column = static_cast<std::int64_t>(std::floor(x));
    const auto row = static_cast<std::int64_t>(std::floor(y));
    const double u = x - std::floor(x), v = y - std::floor(y);
    const auto at = [&](std::int64_t i, std::int64_t j) {
        return Random{seed_, kRoughKey, static_cast<std::uint64_t>(column + i),
                      static_cast<std::uint64_t>(row + j)}
            .uniform(-1, 1);
    };
    return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}
}  // namespace delio::synth
