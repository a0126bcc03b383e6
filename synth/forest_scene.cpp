#include "forest_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "forest_growth.h"
#include "ground.h"
#include "vegetation.h"

namespace delio::synth {
namespace {
using Eigen::Vector2d;
constexpr std::uint64_t kTreeKey = 0x73EE, kUnderKey = 0x0DE3;
constexpr double kTrunkCell_m = 3.5, kTrunksApart_m = 2;
constexpr double kUnderCell_m = 2.2, kUnderApart_m = 0.6;
// From the middle of the track: trunks leave room for who walks beside the vehicle.
constexpr double kTrunk_m = 2.9, kVehicle_m = 1.4, kBush_m = 3.9, kFern_m = 2.9;
constexpr double kDense_m = 20;  // farther away, half of the leaves do

/** A whole number as a key. */
std::uint64_t keyOf(int number) { return static_cast<std::uint64_t>(number + 1000000); }
}  // namespace

std::vector<ForestScene::Spot> ForestScene::spots(int index, std::uint64_t key, double cell_m,
                                                  double apart_m) const {
    Eigen::AlignedBox2d around;
    for (double s = 0; s <= kTileLength_m; s += 2)
        around.extend(road().point(index * kTileLength_m + s, 0));
    const auto cellOf = [&](double metres) {
        return static_cast<int>(std::floor(metres / cell_m));
    };
    const Vector2d low = around.min().array() - kDeep_m, high = around.max().array() + kDeep_m;
    std::vector<Spot> found;
    for (int column = cellOf(low.x()); column <= cellOf(high.x()); ++column)
        for (int row = cellOf(low.y()); row <= cellOf(high.y()); ++row) {
            Random random{seed_, key, keyOf(column), keyOf(row)};
            const double play = (cell_m - apart_m) / 2;
            const Vector2d place(cell_m * (column + 0.5) + play * random.uniform(-1, 1),
                                 cell_m * (row + 0.5) + play * random.uniform(-1, 1));
            const auto nearest = road().nearest(place);
            if (!nearest.segment || tileAt(nearest.segment->s) != index) continue;
            if (nearest.distance < kDeep_m) found.push_back({place, nearest.distance, random});
        }
    return found;
}

std::vector<std::pair<ForestScene::Trunk, ForestScene::Spot>> ForestScene::trees(int index) const {
    std::vector<std::pair<Trunk, Spot>> found;
    for (auto& spot : spots(index, kTreeKey, kTrunkCell_m, kTrunksApart_m)) {
        const bool clearing = spot.random.chance(0.07);
        const double thick = spot.random.uniform();
        const Trunk trunk{spot.place, 0.15 + 0.35 * thick * thick};
        if (!clearing && spot.away_m > kTrunk_m) found.emplace_back(trunk, spot);
    }
    return found;
}

std::vector<ForestScene::Trunk> ForestScene::trunks(int index) const {
    std::vector<Trunk> all;
    for (const auto& tree : trees(index)) all.push_back(tree.first);
    return all;
}

Frame ForestScene::frameAt(const Spot& spot, Random& random) const {
    const Frame level{
        {spot.place.x(), spot.place.y(), road().height(spot.place, spot.away_m)}, {1, 0}, {0, 1}};
    return level.turned(random.uniform(0, 6.2831853));
}

Mesh ForestScene::tile(int index) const {
    Mesh mesh;
    const double begin_s = index * kTileLength_m;
    addGround(mesh, road(), begin_s, begin_s + kTileLength_m);
    for (const auto& [trunk, spot] : trees(index)) {
        Random random = spot.random;
        const Frame frame = frameAt(spot, random);
        const ForestTree tree{trunk.diameter_m, spot.away_m - kVehicle_m, random.chance(0.5),
                              spot.away_m < kDense_m};
        addForestTree(mesh, frame, tree, random);
    }
    for (const auto& spot : spots(index, kUnderKey, kUnderCell_m, kUnderApart_m))
        if (spot.away_m < 0.75 * kDeep_m) addUndergrowth(mesh, spot);
    return mesh;
}

void ForestScene::addUndergrowth(Mesh& mesh, const Spot& spot) const {
    Random random = spot.random;
    const double kind = random.uniform();
    const Frame frame = frameAt(spot, random);
    if (kind < 0.3 && spot.away_m > kFern_m)
        addFern(mesh, frame, random);
    else if (kind < 0.42 && spot.away_m > kBush_m)
        addBush(mesh, frame, random);
    else if (kind < 0.55 && spot.away_m > kFern_m)
        addSapling(mesh, frame, random);
    else if (kind < 0.6 && spot.away_m > kFern_m)
        addStump(mesh, frame, random);
    else if (kind < 0.63 && spot.away_m > kLog_m / 2 + kFern_m)
        addLog(mesh, frame, random);
    else if (kind < 0.8 && spot.away_m > kFern_m)
        addGrass(mesh, frame, 1.6, 1.2, random);
}
}  // namespace delio::synth
