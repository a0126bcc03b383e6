#include "ground.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace delio::synth {
namespace {
constexpr double kRoadHalf_m = 9.2;

/** Triangles over a grid of stations and sideways places. */
void addSheet(Mesh& mesh, const Road& road, const std::vector<double>& stations,
              const std::vector<double>& sides,
              const std::function<double(const Eigen::Vector2d&, double s, double side)>& height,
              const std::function<double(double s, double side)>& reflectivity) {
    const auto columns = static_cast<std::uint32_t>(sides.size());
    std::uint32_t row = 0;
    for (std::size_t i = 0; i < stations.size(); ++i) {
        const auto before = row;
        for (std::uint32_t j = 0; j < columns; ++j) {
            const Eigen::Vector2d place = road.point(stations[i], sides[j]);
            const double z = height(place, stations[i], sides[j]);
            const auto vertex = mesh.addVertex({place.x(), place.y(), z});
            if (j == 0) row = vertex;
        }
        for (std::uint32_t j = 0; i > 0 && j + 1 < columns; ++j) {
            const double middle = (sides[j] + sides[j + 1]) / 2;
            const double colour = reflectivity(stations[i], middle);
            mesh.addTriangle(before + j, before + j + 1, row + j + 1, colour);
            mesh.addTriangle(before + j, row + j + 1, row + j, colour);
        }
    }
}

std::vector<double> steps(double begin, double end, double step) {
    std::vector<double> places;
    const int count = static_cast<int>(std::lround((end - begin) / step));
    for (int i = 0; i <= count; ++i) places.push_back(begin + (end - begin) * i / count);
    return places;
}

double roadReflectivity(double s, double side) {
    const double away = std::abs(side);
    const bool centreDash = away < 0.07 && std::fmod(s + 1e5, 6) < 3;
    const bool parkingLine = away > Road::kLaneEdge_m && away < Road::kLaneEdge_m + 0.12;
    if (centreDash || parkingLine) return 0.8;
    return away < Road::kKerb_m ? 0.24 : 0.36;
}
}  // namespace

void addGround(Mesh& mesh, const Road& road, double begin_s, double end_s) {
    std::vector<double> right = {kRoadHalf_m, 8.7, 7.1, 5.53, Road::kKerb_m, 4.4,
                                 3.42,        3.3, 2.2, 1.1,  0.07};
    std::vector<double> across;
    across.reserve(2 * right.size());
    for (const double side : right) across.push_back(-side);
    across.insert(across.end(), right.rbegin(), right.rend());
    addSheet(
        mesh, road, steps(begin_s, end_s, 0.5), across,
        [&](const Eigen::Vector2d& place, double, double side) { return road.height(place, side); },
        roadReflectivity);

    // In the inside of a turn the land beside one stretch lies over the road of the next: there,
    // and under the edge of the road itself, it is sunk.
    const auto landHeight = [&](const Eigen::Vector2d& place, double s, double) {
        const bool underRoad = road.distance(place, s) < kRoadHalf_m - 0.1;
        return road.height(place) - (underRoad ? 0.8 : 0);
    };
    for (const double sign : {-1.0, 1.0}) {
        auto sides = steps(kRoadHalf_m, 60, 4);
        sides.insert(sides.begin(), kRoadHalf_m - 0.5);
        for (auto& side : sides) side *= sign;
        addSheet(mesh, road, steps(begin_s, end_s, 4), sides, landHeight,
                 [](double, double) { return 0.3; });
    }
}
}  // namespace delio::synth
