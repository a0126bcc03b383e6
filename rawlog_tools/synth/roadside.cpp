#include "roadside.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
constexpr double kVehicleHalf_m = 1.7;  // with some air beside it
/** How far the station nearest to an object may be from its own, in a bend. */
constexpr double kSameStretch_m = 30;
}  // namespace

Random RoadsideScene::stream(int tile, double side, std::uint64_t part) const {
    return streamOf(seed_, tile, side, part);
}

Random RoadsideScene::streamOf(std::uint64_t seed, int tile, double side, std::uint64_t part) {
    return Random{seed, static_cast<std::uint64_t>(tile + 1000000), side > 0 ? 1U : 0U, part};
}

Random RoadsideScene::stretchStream(double s, double length_m, double side,
                                    std::uint64_t part) const {
    return stream(static_cast<int>(std::floor(s / length_m)), side, part);
}

Frame RoadsideScene::frameAt(double s, double side) const {
    const double yaw = road().path().at(s).yaw;
    const Eigen::Vector2d x(std::cos(yaw), std::sin(yaw));
    const Eigen::Vector2d y = (side > 0 ? 1 : -1) * Eigen::Vector2d(-x.y(), x.x());
    const Eigen::Vector2d place = road().point(s, side);
    return {{place.x(), place.y(), road().height(place)}, x, y};
}

bool RoadsideScene::isFree(const Frame& frame, double s, double length, double width,
                           double clearance) const {
    if (!road().owns(s)) return false;
    const int along = static_cast<int>(length / 2) + 1, across = static_cast<int>(width / 2) + 1;
    for (int i = 0; i <= along; ++i)
        for (int j = 0; j <= across; ++j) {
            const Eigen::Vector2d place =
                frame.world((1.0 * i / along - 0.5) * length, (1.0 * j / across - 0.5) * width, 0)
                    .head<2>();
            const auto nearest = road().nearest(place);
            if (nearest.distance < clearance) return false;
            if (nearest.segment && std::abs(nearest.segment->s - s) > kSameStretch_m + length / 2)
                return false;
            if (road().distanceToVehicle(place, kVehicleHalf_m) < kVehicleHalf_m) return false;
        }
    return true;
}

bool RoadsideScene::isStripFree(double s0, double s1, double side) const {
    const int parts = std::max(1, static_cast<int>((s1 - s0) / 2));
    for (int i = 0; i <= parts; ++i) {
        const double s = s0 + (s1 - s0) * i / parts;
        if (!isFree(frameAt(s, side), s, 0.1, 0.1, std::abs(side) - 0.4)) return false;
    }
    return true;
}

double RoadsideScene::sharpestCurvature(double begin_s, double end_s) const {
    double sharpest = 1e-6;
    for (double s = begin_s; s <= end_s; s += 1)
        sharpest = std::max(sharpest, std::abs(road().path().at(s).curvature));
    return sharpest;
}
}  // namespace delio::synth
