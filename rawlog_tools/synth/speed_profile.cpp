#include "speed_profile.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kStep_m = 0.25;
constexpr double kAcceleration_m_s2 = 1.7;
constexpr double kBraking_m_s2 = 2.0;
constexpr double kSideways_m_s2 = 4.0;  // what passengers put up with in a bend

/** Which steps are stops, and for how many seconds: at a light, behind others. */
std::map<std::size_t, double> drawStops(double spacing_m, double end_m, std::uint64_t seed) {
    std::map<std::size_t, double> stops;
    if (spacing_m <= 0) return stops;
    Random random{seed, 0x570};
    for (double s = random.uniform(0.25, 0.8) * spacing_m; s < end_m;
         s += spacing_m * random.uniform(0.5, 1.5))
        stops[static_cast<std::size_t>(s / kStep_m)] = random.uniform(2.5, 7);
    return stops;
}

/** Minimum of the driver's speed and the curve's limit. */
std::vector<double> wantedSpeed(const Path& path, const DrivingStyle& style, Random& random) {
    const double cruise = random.uniform(style.slowest_m_s, style.fastest_m_s);
    std::vector<double> speed;
    double mood = 1, until = 0;
    for (double s = 0; s <= path.end(); s += kStep_m) {
        if (s >= until) {
            mood = std::max(random.uniform(0.9, 1), style.slowest_m_s / cruise);
            until = s + random.uniform(60, 250);
        }
        const double curvature = std::max(1e-6, std::abs(path.at(s).curvature));
        speed.push_back(std::min({mood * cruise, style.maxYawRate_rad_s / curvature,
                                  std::sqrt(kSideways_m_s2 / curvature)}));
    }
    return speed;
}

void limitAcceleration(std::vector<double>& speed) {
    const auto limit = [](double& value, double neighbour, double acceleration) {
        value = std::min(value, std::sqrt(neighbour * neighbour + 2 * acceleration * kStep_m));
    };
    for (std::size_t i = speed.size() - 1; i-- > 0;) limit(speed[i], speed[i + 1], kBraking_m_s2);
    for (std::size_t i = 1; i < speed.size(); ++i)
        limit(speed[i], speed[i - 1], kAcceleration_m_s2);
}
}  // namespace

SpeedProfile::SpeedProfile(const Path& path, const DrivingStyle& style, std::uint64_t seed)
    : path_(path) {
    Random random{seed, 0xD71};
    auto speed = wantedSpeed(path, style, random);
    const auto stops = drawStops(style.stopSpacing_m, path.end(), seed);
    for (const auto& stop : stops)
        if (stop.first < speed.size()) speed[stop.first] = 0;
    if (!Random{seed, 0x57A7}.chance(style.movingStart)) speed[0] = 0;
    limitAcceleration(speed);
    for (std::size_t i = 0; i + 1 < speed.size(); ++i) {
        const double station = kStep_m * static_cast<double>(i);
        if (const auto stop = stops.find(i); stop != stops.end()) {
            legs_.push_back({end_s_, station, 0, 0});
            end_s_ += stop->second;
        }
        const double duration = 2 * kStep_m / (speed[i] + speed[i + 1]);
        legs_.push_back({end_s_, station, speed[i], (speed[i + 1] - speed[i]) / duration});
        end_s_ += duration;
    }
}

double SpeedProfile::stationAt(double time_s) const {
    const auto next = std::upper_bound(legs_.begin(), legs_.end(), time_s,
                                       [](double t, const Leg& leg) { return t < leg.begin_s; });
    if (next == legs_.begin()) return legs_.front().speed * time_s;  // before the first scan
    const Leg& leg = *std::prev(next);
    const double t = time_s - leg.begin_s;
    return leg.station + leg.speed * t + leg.acceleration * t * t / 2;
}

PlanPose SpeedProfile::at(double time_s) const {
    const Station station = path_.at(stationAt(time_s));
    return {station.s, station.x, station.y, station.yaw};
}
}  // namespace delio::synth
