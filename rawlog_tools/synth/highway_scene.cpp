#include "highway_scene.h"

#include <cmath>

#include "ground.h"
#include "highway_furniture.h"
#include "vegetation.h"

namespace delio::synth {
namespace {
constexpr double kPost_m = 4;          // from post to post
constexpr double kMedianRail_m = 0.9;  // from the centre line
constexpr double kOuterRail_m = 16.7, kSign_m = 18, kWall_m = 19.5;
constexpr double kWallStretch_m = 240, kGrowthStretch_m = 200;

enum Part : std::uint64_t { kWalls = 20, kRailPart, kTrees, kSigns, kOver };
}  // namespace

Mesh HighwayScene::tile(int index) const {
    const double begin_s = index * kTileLength_m;
    Mesh mesh;
    addGround(mesh, road(), begin_s, begin_s + kTileLength_m);
    for (const double side : {-1.0, 1.0}) {
        addRails(mesh, begin_s, side);
        addWall(mesh, begin_s, side);
        addTrees(mesh, begin_s, side, stream(index, side, kTrees));
        addSigns(mesh, begin_s, side, stream(index, side, kSigns));
    }
    addCrossings(mesh, index);
    return mesh;
}

std::vector<Feet> HighwayScene::freeFeet(double begin_s, double side) const {
    std::vector<Feet> pieces;
    for (double s = begin_s; s < begin_s + kTileLength_m; s += kPost_m)
        if (isStripFree(s, s + kPost_m, side)) {
            const auto at = [&](double along) { return frameAt(along, side).origin; };
            if (pieces.empty() || pieces.back().back() != at(s)) pieces.push_back({at(s)});
            pieces.back().push_back(at(s + kPost_m));
        }
    return pieces;
}

void HighwayScene::addRails(Mesh& mesh, double begin_s, double side) const {
    const bool toTheRight = side > 0;  // seen along the road, from the rail to the lanes
    for (const auto& feet : freeFeet(begin_s, side * kMedianRail_m))
        addGuardRail(mesh, feet, !toTheRight);
    if (!stretchStream(begin_s, kGrowthStretch_m, side, kRailPart).chance(0.7)) return;
    for (const auto& feet : freeFeet(begin_s, side * kOuterRail_m))
        addGuardRail(mesh, feet, toTheRight);
}

bool HighwayScene::hasWall(double s, double side) const {
    return stretchStream(s, kWallStretch_m, side, kWalls).chance(0.3);
}

void HighwayScene::addWall(Mesh& mesh, double begin_s, double side) const {
    if (!hasWall(begin_s, side)) return;
    Random random = stretchStream(begin_s, kWallStretch_m, side, kWalls + 100);
    const double height = random.uniform(2.5, 4.5);
    for (const auto& feet : freeFeet(begin_s, side * kWall_m)) addNoiseWall(mesh, feet, height);
}

void HighwayScene::addTrees(Mesh& mesh, double begin_s, double side, Random random) const {
    const double spacing = stretchStream(begin_s, kGrowthStretch_m, side, kTrees).uniform(1.2, 9);
    const double end_s = begin_s + kTileLength_m;
    for (double s = begin_s; s < end_s; s += random.uniform(0.5, 1.5) * spacing) {
        const double spread = random.uniform();
        const Frame frame = frameAt(s, side * (24 + 66 * spread * spread));
        if (!isFree(frame, s, 4, 4, 22)) continue;
        const double kind = random.uniform();
        if (kind < 0.35)
            addBush(mesh, frame, random);
        else if (kind < 0.75)
            addTallTree(mesh, frame, random);
        else
            addConifer(mesh, frame, random);
    }
    for (double s = begin_s; s < end_s; s += random.uniform(2, 6)) {
        const Frame frame = frameAt(s, side * random.uniform(17.8, 19));
        if (isFree(frame, s, 3, 1.5, 17)) addGrass(mesh, frame, 3, 1.5, random);
    }
}

void HighwayScene::addSigns(Mesh& mesh, double begin_s, double side, Random random) const {
    const Frame post = frameAt(begin_s + 10, side * 16.3);
    if (isFree(post, begin_s, 0.2, 0.2, 16)) addDelineator(mesh, post);
    if (!random.chance(0.16)) return;
    const double s = begin_s + random.uniform(5, 35);
    const Frame frame = frameAt(s, side * kSign_m);
    if (isFree(frame, s, 0.5, 1.4, kOuterRail_m)) addDirectionSign(mesh, frame, random);
}

void HighwayScene::addCrossings(Mesh& mesh, int index) const {
    Random random = stream(index, 1, kOver);
    const double s = (index + 0.5) * kTileLength_m;
    if (!road().owns(s)) return;
    const double kind = random.uniform();
    if (kind < 0.05) {
        if (!hasWall(s, 1) && !hasWall(s, -1) && isStripFree(s - 8, s + 8, 17.5) &&
            isStripFree(s - 8, s + 8, -17.5))
            addBridge(mesh, frameAt(s, 0), 18.2, random);
    } else if (kind < 0.12) {
        const double side = random.chance(0.6) ? -1 : 1;
        if (isStripFree(s, s + 1, side * 17))
            addGantry(mesh, frameAt(s, 0), side * 0.4, side * 17.4, random);
    }
}
}  // namespace delio::synth
