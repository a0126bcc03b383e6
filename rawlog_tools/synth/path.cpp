#include "path.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kStep = 0.25;
constexpr double kDegree = 3.14159265358979323846 / 180;

/** Along a short arc, by the direction in its middle. */
Station advanced(const Station& from, double ds) {
    Station to = from;
    const double middleYaw = from.yaw + from.curvature * ds / 2;
    to.s += ds;
    to.x += ds * std::cos(middleYaw);
    to.y += ds * std::sin(middleYaw);
    to.yaw += from.curvature * ds;
    return to;
}
}  // namespace

void appendTurn(std::vector<CurvaturePiece>& pieces, double angle, double radius, double ease) {
    const double curvature = std::copysign(1 / radius, angle);
    const double arc = std::max(0.0, std::abs(angle) * radius - ease);
    // A turn too short for an arc gets the curvature that its two clothoids can reach.
    const double peak = arc > 0 ? curvature : angle / ease;
    pieces.push_back({ease, peak});
    pieces.push_back({arc, peak});
    pieces.push_back({ease, 0});
}

Path::Path(double begin_s, const std::vector<CurvaturePiece>& pieces) {
    Station station;
    station.s = begin_s;
    station.x = begin_s;
    double pieceBegin = begin_s, before = 0;
    stations_.push_back(station);
    for (const auto& piece : pieces) {
        const double pieceEnd = pieceBegin + piece.length;
        while (station.s + kStep <= pieceEnd) {
            const double middle = station.s + kStep / 2;
            const double u = std::clamp((middle - pieceBegin) / piece.length, 0.0, 1.0);
            station.curvature = before + (piece.curvature - before) * u;
            stations_.back().curvature = station.curvature;
            station = advanced(station, kStep);
            stations_.push_back(station);
        }
        pieceBegin = pieceEnd;
        before = piece.curvature;
    }
    stations_.back().curvature = 0;
}

Path::Path(const std::vector<Station>& dense) {
    std::size_t next = 1;
    for (double s = dense.front().s; s <= dense.back().s && next < dense.size(); s += kStep) {
        while (next + 1 < dense.size() && dense[next].s < s) ++next;
        const Station &a = dense[next - 1], &b = dense[next];
        const double u = std::clamp((s - a.s) / (b.s - a.s), 0.0, 1.0);
        const auto between = [u](double from, double to) { return from + u * (to - from); };
        stations_.push_back({s, between(a.x, b.x), between(a.y, b.y), between(a.yaw, b.yaw),
                             between(a.curvature, b.curvature)});
    }
}

Station Path::at(double s) const {
    if (s < begin()) {
        Station first = stations_.front();
        first.curvature = 0;
        return advanced(first, s - begin());
    }
    const auto last = stations_.size() - 1;
    const auto index = std::min(last, static_cast<std::size_t>((s - begin()) / kStep));
    return advanced(stations_[index], s - stations_[index].s);
}

Path urbanPath(std::uint64_t seed, double length_m) {
    Random random{seed, 0x9A7};
    double heading = 0, length = random.uniform(25, 35);
    std::vector<CurvaturePiece> pieces = {{kPathMargin_m + length, 0}};
    const auto turnTo = [&](double target, double radius, double ease) {
        const auto first = pieces.size();
        appendTurn(pieces, target - heading, radius, ease);
        heading = target;
        for (auto i = first; i < pieces.size(); ++i) length += pieces[i].length;
    };
    const auto goStraight = [&](double metres) {
        pieces.push_back({metres, 0});
        length += metres;
    };
    // Streets lead alternately to the side and along +x; the stretches along +x keep the side
    // streets at least 80 m apart.
    for (bool side = true; length < length_m + 2 * kPathMargin_m; side = !side) {
        const double away = random.uniform(60, 80) * kDegree;
        const double target =
            side ? (random.chance(0.5) ? away : -away) : random.uniform(-6, 6) * kDegree;
        const double radius = random.uniform(13.5, 18);
        turnTo(target, radius, random.uniform(7, 10));
        goStraight(random.uniform(40, 70));
        const double bend = random.uniform(-7, 7) * kDegree;
        turnTo(heading + bend, random.uniform(120, 250), 15);
        goStraight(random.uniform(30, 60));
    }
    goStraight(kPathMargin_m);
    return Path(-kPathMargin_m, pieces);
}
}  // namespace delio::synth
