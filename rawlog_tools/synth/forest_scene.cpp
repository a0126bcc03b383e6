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
constexpr double kTrunksApart_m = 2.1, kUnderApart_m = 1.3;
// From the middle of the track: trunks leave room for who walks beside the vehicle.
constexpr double kTrunk_m = 2.9, kVehicle_m = 1.4, kBush_m = 3.9, kFern_m = 2.9;
constexpr double kDense_m = 20;  // farther away, half of the leaves do

struct Seedling {
    Vector2d place;
    double strength;
    Random random;  //!< for what it becomes
};

/** One seedling in every cell of a lattice over the land; where two are too near to each other, the
 *  stronger one stands. So the lattice cannot be seen. */
struct Thicket {
    std::uint64_t seed, key;
    double apart_m;

    double cell_m() const { return 0.7 * apart_m; }
    int cellOf(double metres) const { return static_cast<int>(std::floor(metres / cell_m())); }
    Seedling at(int column, int row) const {
        const auto keyOf = [](int number) {
            return std::uint64_t{1000000} + static_cast<std::uint64_t>(number);
        };
        Random random{seed, key, keyOf(column), keyOf(row)};
        const double u = random.uniform(), v = random.uniform(), strength = random.uniform();
        return {{cell_m() * (column + u), cell_m() * (row + v)}, strength, random};
    }
    bool stands(int column, int row) const {
        const Seedling own = at(column, row);
        for (int i = -2; i <= 2; ++i)
            for (int j = -2; j <= 2; ++j) {
                if (i == 0 && j == 0) continue;
                const Seedling other = at(column + i, row + j);
                if (other.strength > own.strength && (other.place - own.place).norm() < apart_m)
                    return false;
            }
        return true;
    }
};
}  // namespace

std::vector<ForestScene::Spot> ForestScene::spots(int index, std::uint64_t key,
                                                  double apart_m) const {
    Eigen::AlignedBox2d around;
    for (double s = 0; s <= kTileLength_m; s += 2)
        around.extend(road().point(index * kTileLength_m + s, 0));
    const Thicket thicket{seed_, key, apart_m};
    const int columns = thicket.cellOf(around.max().x() + kDeep_m);
    const int rows = thicket.cellOf(around.max().y() + kDeep_m);
    std::vector<Spot> found;
    for (int column = thicket.cellOf(around.min().x() - kDeep_m); column <= columns; ++column)
        for (int row = thicket.cellOf(around.min().y() - kDeep_m); row <= rows; ++row) {
            if (!thicket.stands(column, row)) continue;
            const Seedling seedling = thicket.at(column, row);
            const auto nearest = road().nearest(seedling.place);
            if (!nearest.segment || tileAt(nearest.segment->s) != index) continue;
            if (nearest.distance < kDeep_m)
                found.push_back({seedling.place, nearest.distance, seedling.random});
        }
    return found;
}

std::vector<std::pair<ForestScene::Trunk, ForestScene::Spot>> ForestScene::trees(int index) const {
    std::vector<std::pair<Trunk, Spot>> found;
    for (auto& spot : spots(index, kTreeKey, kTrunksApart_m)) {
        const bool clearing = spot.random.chance(0.04);
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
    for (const auto& spot : spots(index, kUnderKey, kUnderApart_m))
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
