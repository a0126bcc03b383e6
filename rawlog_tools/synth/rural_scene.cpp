#include "rural_scene.h"

#include <algorithm>
#include <cmath>

#include "building.h"
#include "furniture.h"
#include "ground.h"
#include "highway_furniture.h"
#include "vegetation.h"

namespace delio::synth {
namespace {
enum Part : std::uint64_t { kBoundary = 10, kGrowth, kWood, kFarm, kPosts };
constexpr double kPanel_m = 2.5;
constexpr double kField_m = 160;  // so far, one field's fence or hedge reaches
}  // namespace

Mesh RuralScene::tile(int index) const {
    const double begin_s = index * kTileLength_m;
    Mesh mesh;
    addGround(mesh, road(), begin_s, begin_s + kTileLength_m);
    for (const double side : {-1.0, 1.0}) {
        addBoundary(mesh, begin_s, side, stream(index, side, kBoundary));
        addFarm(mesh, begin_s, side, stream(index, side, kFarm));
        addGrowth(mesh, begin_s, side, 5.2, 60, stream(index, side, kGrowth));
        addPosts(mesh, begin_s, side, stream(index, side, kPosts));
    }
    return mesh;
}

Feet RuralScene::feetBetween(double s0, double s1, double step, double side) const {
    Feet feet;
    const int count = static_cast<int>(std::lround((s1 - s0) / step));
    for (int i = 0; i <= count; ++i)
        feet.push_back(frameAt(s0 + (s1 - s0) * i / count, side).origin);
    return feet;
}

void RuralScene::addBoundary(Mesh& mesh, double begin_s, double side, Random random) const {
    Random field = stretchStream(begin_s, kField_m, side, kBoundary);
    const double kind = field.uniform(), away = field.uniform(7.6, 10.5);
    for (double s = begin_s; s < begin_s + kTileLength_m; s += 4 * kPanel_m) {
        if (random.chance(0.08)) continue;  // a gate, a gap
        const double next = s + 4 * kPanel_m;
        if (!isStripFree(s, next, side * away)) continue;
        if (kind < 0.3)
            addFieldFence(mesh, feetBetween(s, next, kPanel_m, side * away), field);
        else if (kind < 0.6)
            addHedgeRow(mesh, s, next, side * away, random);
        else if (kind < 0.75)
            addStoneWall(mesh, feetBetween(s, next, kPanel_m, side * away), random);
    }
}

void RuralScene::addHedgeRow(Mesh& mesh, double s0, double s1, double side, Random& random) const {
    for (double s = s0; s < s1; s += kPanel_m) {
        const Frame frame = frameAt(s + kPanel_m / 2, side);
        addHedge(mesh, frame.turned(random.uniform(-0.06, 0.06)), kPanel_m + 0.4, random);
        if (random.chance(0.15)) addBush(mesh, frame.at(0, random.uniform(-0.5, 1), 0), random);
    }
}

void RuralScene::addGrowth(Mesh& mesh, double begin_s, double side, double near, double far,
                           Random random) const {
    const double end_s = begin_s + kTileLength_m;
    const double rank = stretchStream(begin_s, 80, side, kGrowth).uniform(0.2, 1);
    for (double s = begin_s + random.uniform(0, 3); s < end_s; s += random.uniform(2.5, 5)) {
        const Frame frame = frameAt(s, side * random.uniform(near, near + 2.5));
        if (isFree(frame, s, 3, 1.5, near - 0.8)) addGrass(mesh, frame, 3, 1.5, random);
        if (!random.chance(0.5 * rank)) continue;
        const Frame place = frameAt(s, side * random.uniform(near + 1.8, near + 14));
        if (isFree(place, s, 2, 2, near + 0.5)) addBush(mesh, place, random);
    }
    // Single trees, or a wood.
    const bool wood = stretchStream(begin_s, kField_m, side, kWood).chance(0.4);
    const double spacing = wood ? 1.5 : 6;
    for (double s = begin_s; s < end_s; s += random.uniform(0.6, 1.4) * spacing) {
        const double spread = random.uniform();
        const double away = near + 3.5 + (far - near - 3.5) * spread * spread;
        const Frame frame = frameAt(s, side * away);
        if (!isFree(frame, s, 4, 4, near + 1)) continue;
        if (random.chance(0.7))
            addTallTree(mesh, frame, random);
        else
            addConifer(mesh, frame, random);
    }
}

void RuralScene::addFarm(Mesh& mesh, double begin_s, double side, Random random) const {
    if (!random.chance(0.14)) return;
    const double s = begin_s + kTileLength_m / 2;
    const double width = random.uniform(9, 15), depth = random.uniform(7, 10);
    const Frame house = frameAt(s, side * random.uniform(14, 24)).turned(random.uniform(-0.5, 0.5));
    if (isFree(house.at(0, depth / 2, 0), s, width, depth, 11))
        addBuilding(mesh, house.at(-width / 2, 0, 0), width, depth, random, 2);
    const Frame barn = frameAt(s - 12, side * random.uniform(30, 42)).turned(random.uniform(-1, 1));
    if (isFree(barn, s, 18, 10, 14)) addBlock(mesh, barn.at(-9, -5, 0), 18, 10, random);
}

void RuralScene::addPosts(Mesh& mesh, double begin_s, double side, Random random) const {
    const Frame delineator = frameAt(begin_s + 20, side * 4.2);
    if (isFree(delineator, begin_s + 20, 0.3, 0.3, 4)) addDelineator(mesh, delineator);
    const bool line = stretchStream(begin_s, 4 * kField_m, 1, kPosts).chance(0.5) == (side > 0);
    const Frame pole = frameAt(begin_s + random.uniform(4, 8), side * 7.2);
    if (line && isFree(pole, begin_s, 0.5, 0.5, 6.5)) addPole(mesh, pole, random);
    const Frame sign = frameAt(begin_s + 31, side * 4.6);
    if (random.chance(0.12) && isFree(sign, begin_s + 31, 0.5, 0.5, 4)) addSign(mesh, sign, random);
}
}  // namespace delio::synth
