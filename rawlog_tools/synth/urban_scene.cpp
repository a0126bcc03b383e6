#include "urban_scene.h"

#include <algorithm>
#include <cmath>

#include "building.h"
#include "furniture.h"
#include "ground.h"

namespace delio::synth {
namespace {
constexpr double kFacade_m = 9.0;

enum Part : std::uint64_t { kHouses, kBackRow, kCars, kSidewalk };
}  // namespace

Mesh UrbanScene::tile(int index) const {
    const double begin_s = index * kTileLength_m;
    Mesh mesh;
    addGround(mesh, road(), begin_s, begin_s + kTileLength_m);
    for (const double side : {-1.0, 1.0}) {
        addHouses(mesh, begin_s, side, stream(index, side, kHouses));
        addBackRow(mesh, begin_s, side, stream(index, side, kBackRow));
        if (parkedSeed_ != 0)
            addParkedCars(mesh, begin_s, side,
                          streamOf(parkedSeed_.value_or(seed()), index, side, kCars));
        addSidewalk(mesh, begin_s, side, stream(index, side, kSidewalk));
    }
    return mesh;
}

void UrbanScene::addHouses(Mesh& mesh, double begin_s, double side, Random random) const {
    const double end_s = begin_s + kTileLength_m;
    for (double s = begin_s; s < end_s - 5;) {
        if (random.chance(0.22)) {  // a cross street, a drive, a yard
            const double gap = random.uniform(3, 10);
            addYard(mesh, s + gap / 2, side, random);
            s += gap;
            continue;
        }
        // Round a turn the fronts are short: a long one would reach into the road.
        const double longest = 0.3 / sharpestCurvature(s, s + 8);
        const double next = std::min({end_s, s + random.uniform(8, 17), s + longest});
        addHouse(mesh, s, next, side, random);
        s = next;
    }
}

void UrbanScene::addYard(Mesh& mesh, double s, double side, Random& random) const {
    for (double away = random.uniform(11, 16); away < 40; away += random.uniform(4, 9)) {
        const Frame frame = frameAt(s + random.uniform(-4, 4), side * away);
        if (!isFree(frame, s, 3, 3, kFacade_m)) continue;
        const double kind = random.uniform();
        if (kind < 0.4)
            addTree(mesh, frame, random);
        else if (kind < 0.8) {
            const Frame turned = frame.turned(random.uniform(0, 3));
            addHedge(mesh, turned, random.uniform(1, 5), random);
        }
    }
}

void UrbanScene::addHouse(Mesh& mesh, double s0, double s1, double side, Random& random) const {
    const double setback = random.chance(0.5) ? 0 : random.uniform(0.3, 5);
    const double depth = random.uniform(8, 13), skew = random.uniform(-0.05, 0.05);
    const Eigen::Vector2d begin = road().point(s0, side * (kFacade_m + setback));
    const Eigen::Vector2d end = road().point(s1, side * (kFacade_m + setback));
    const double width = (end - begin).norm() - 0.2;
    if (width < 4) return;
    const Eigen::Vector2d x = (end - begin).normalized();
    const Eigen::Vector2d y = side * Eigen::Vector2d(-x.y(), x.x());
    const Eigen::Vector2d middle = (begin + end) / 2;
    const Frame centre{{middle.x(), middle.y(), road().height(middle)}, x, y};
    const Frame skewed = centre.turned(skew);
    // Balconies, steps and bay windows stand before the front.
    if (!isFree(skewed.at(0, depth / 2, 0), (s0 + s1) / 2, width, depth, Road::kKerb_m + 2.3))
        return;
    addBuilding(mesh, skewed.at(-width / 2, 0, 0), width, depth, random);
    if (setback > 1.5) addFrontGarden(mesh, s0, s1, side, random);
}

void UrbanScene::addFrontGarden(Mesh& mesh, double s0, double s1, double side,
                                Random& random) const {
    const double kind = random.uniform(), length = s1 - s0 - random.uniform(1.5, 3);
    const double s = (s0 + s1) / 2;
    if (std::abs(road().path().at(s).curvature) > 0.02) return;
    const Frame frame = frameAt(s, side * Road::kSidewalkEnd_m);
    if (!isFree(frame, s, length, 0.8, Road::kKerb_m + 1)) return;
    if (kind < 0.45)
        addHedge(mesh, frame, length, random);
    else if (kind < 0.8)
        addGardenWall(mesh, frame, length, random);
    if (random.chance(0.3)) {
        const Frame garden = frame.at(random.uniform(-0.4, 0.4) * length, 1.2, 0);
        addHedge(mesh, garden.turned(random.uniform(0, 3)), 1.2, random);
    }
}

void UrbanScene::addBackRow(Mesh& mesh, double begin_s, double side, Random random) const {
    const double s = begin_s + random.uniform(8, 32);
    const Frame frame = frameAt(s, side * random.uniform(32, 46)).turned(random.uniform(-0.3, 0.3));
    const double width = random.uniform(10, 28), depth = random.uniform(8, 14);
    if (!isFree(frame, s, width, depth, kFacade_m + 6)) return;
    addBlock(mesh, frame.at(-width / 2, -depth / 2, 0), width, depth, random);
}

void UrbanScene::addParkedCars(Mesh& mesh, double begin_s, double side, Random random) const {
    const double lane = (Road::kLaneEdge_m + Road::kKerb_m) / 2 + 0.05;
    double s = begin_s + random.uniform(3, 5);
    while (s < begin_s + kTileLength_m - kCarLength_m / 2) {
        const double sway = random.uniform(-0.02, 0.02);
        const bool straight = std::abs(road().path().at(s).curvature) < 0.015;
        if (random.chance(0.5) && straight) {
            const Frame frame = frameAt(s, side * lane);
            const Frame turned = frame.turned(random.chance(0.8) ? sway : sway + 3.1416);
            if (isFree(frame, s, kCarLength_m, kCarWidth_m, Road::kLaneEdge_m))
                addCar(mesh, turned, random);
        }
        s += kCarLength_m + random.uniform(0.5, 2.5);
    }
}

void UrbanScene::addSidewalk(Mesh& mesh, double begin_s, double side, Random random) const {
    for (double s = begin_s + random.uniform(1, 4); s < begin_s + kTileLength_m;
         s += random.uniform(3, 7)) {
        const double kind = random.uniform();
        const double place = side * random.uniform(6.1, 6.6);
        const Frame frame = frameAt(s, place);
        if (!isFree(frame, s, 0.8, 0.8, Road::kKerb_m)) continue;
        if (kind < 0.38)
            addTree(mesh, frame, random);
        else if (kind < 0.52)
            addLampPost(mesh, frame, random);
        else if (kind < 0.68)
            addSign(mesh, frame.turned(random.uniform(-0.3, 0.3)), random);
        else if (kind < 0.78)
            addBin(mesh, frame.at(0, 1.6, 0), random);
    }
}
}  // namespace delio::synth
