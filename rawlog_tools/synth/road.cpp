#include "road.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace delio::synth {
namespace {
constexpr double kSample_m = 1;
constexpr double kSameRoad_m = 2.5;  // centre lines closer than that are one road's
constexpr double kComeBack_m = 30;   // a line is not compared with what it has just left
}  // namespace

Road::Road(Path path, std::uint64_t seed, RoadProfile profile)
    : Road(std::move(path), seed, std::move(profile), nullptr) {}

Road::Road(Path path, std::uint64_t seed, RoadProfile profile, std::shared_ptr<const Motion> motion)
    : path_(std::move(path)),
      profile_(std::move(profile)),
      terrain_(profile_, seed),
      motion_(std::move(motion)) {
    buildIndices();
}

void Road::buildIndices() {
    const auto count = static_cast<std::size_t>((path_.end() - path_.begin()) / kSample_m);
    const auto stationOf = [&](std::size_t i) {
        return path_.begin() + kSample_m * static_cast<double>(i);
    };
    std::vector<LineIndex::Segment> centres(count);
    LineIndex soFar;
    owned_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const double s = stationOf(i), next = stationOf(i + 1);
        centres[i] = {point(s, 0), point(next, 0), s, false, false};
        tracks_.add({point(s, vehicleSide()), point(next, vehicleSide()), s, false, false});
        const auto earlier = soFar.nearest(centres[i].a, kSameRoad_m, s - kComeBack_m);
        owned_[i] = earlier.segment == nullptr;
        if (owned_[i]) soFar.add(centres[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!owned_[i]) continue;
        // Beyond the ends of the path the road continues straight.
        centres[i].first = i > 0 && !owned_[i - 1];
        centres[i].last = i + 1 < count && !owned_[i + 1];
        centres_.add(centres[i]);
    }
}

bool Road::owns(double s) const {
    const auto i = static_cast<std::ptrdiff_t>(std::floor((s - path_.begin()) / kSample_m));
    return i >= 0 && i < static_cast<std::ptrdiff_t>(owned_.size()) &&
           owned_[static_cast<std::size_t>(i)] != 0;
}

Eigen::Vector2d Road::point(double s, double side_m) const {
    const Station at = path_.at(s);
    const double d = side_m - vehicleSide();
    return {at.x - d * std::sin(at.yaw), at.y + d * std::cos(at.yaw)};
}

double Road::height(const Eigen::Vector2d& place, double away_m) const {
    const double away = std::abs(away_m);
    return terrain_.height(place) + profile_.height(away) + terrain_.besideRoad(place, away);
}

std::vector<double> Road::stationsNear(const Eigen::Vector2d& place, double reach_m) const {
    std::vector<double> stations;
    centres_.visit(place, reach_m, [&](const auto& segment) { stations.push_back(segment.s); });
    return stations;
}
}  // namespace delio::synth
