#include "road_user.h"

#include "furniture.h"
#include "random.h"

namespace delio::synth {
namespace {
constexpr std::uint64_t kLooksKey = 0x40AD;

/** Legs apart as in a stride, trunk, arms and head; the hips `hips_m` above the ground. */
void addPerson(Mesh& mesh, const Frame& frame, double height_m, Random& random) {
    const double hips = 0.5 * height_m, shoulders = 0.83 * height_m;
    const double clothes = random.uniform(0.1, 0.6), trousers = random.uniform(0.08, 0.4);
    for (const double side : {-1.0, 1.0}) {
        mesh.addFrustum(frame, {0.22 * side, 0.09 * side, 0.2, 0.1}, 0,
                        {0, 0.09 * side, 0.18, 0.16}, hips, trousers);
        mesh.addFrustum(frame, {-0.2 * side, 0.24 * side, 0.08, 0.08}, hips,
                        {0, 0.2 * side, 0.1, 0.1}, shoulders, clothes);
    }
    mesh.addFrustum(frame, {0, 0, 0.22, 0.32}, hips, {0, 0, 0.22, 0.4}, shoulders, clothes);
    mesh.addPost(frame, 0.06, 0.06, shoulders, 0.88 * height_m, 0.4);
    mesh.addPost(frame, 0.09, 0.08, 0.88 * height_m, height_m, 0.3);
}

/** A wheel: a thin upright disc, thick enough to be hit from behind. */
void addWheel(Mesh& mesh, const Frame& frame, double x) {
    constexpr double kRadius_m = 0.34, kWidth_m = 0.04;
    mesh.addFrustum(frame, {x, 0, kRadius_m, kWidth_m}, 0, {x, 0, 2 * kRadius_m, kWidth_m},
                    kRadius_m, 0.1);
    mesh.addFrustum(frame, {x, 0, 2 * kRadius_m, kWidth_m}, kRadius_m, {x, 0, kRadius_m, kWidth_m},
                    2 * kRadius_m, 0.1);
}

void addCyclist(Mesh& mesh, const Frame& frame, Random& random) {
    const double clothes = random.uniform(0.15, 0.6);
    for (const double x : {-0.52, 0.52}) addWheel(mesh, frame, x);
    mesh.addBox(frame, {0, 0, 0.9, 0.05}, 0.55, 0.62, 0.3);     // frame
    mesh.addBox(frame, {0.42, 0, 0.06, 0.5}, 0.98, 1.03, 0.2);  // handlebar
    mesh.addPost(frame.at(0.45, 0, 0), 0.025, 0.025, 0.6, 1.0, 0.3);
    for (const double side : {-1.0, 1.0}) {
        mesh.addFrustum(frame, {0.05, 0.12 * side, 0.22, 0.1}, 0.3 + 0.1 * side,
                        {-0.15, 0.1 * side, 0.2, 0.15}, 0.95, 0.15);
        mesh.addFrustum(frame, {0.4, 0.2 * side, 0.08, 0.08}, 1.02, {0.08, 0.2 * side, 0.1, 0.1},
                        1.42, clothes);
    }
    mesh.addFrustum(frame, {-0.15, 0, 0.24, 0.32}, 0.92, {0.08, 0, 0.22, 0.4}, 1.48, clothes);
    mesh.addPost(frame.at(0.16, 0, 0), 0.09, 0.1, 1.5, 1.78, 0.35);
}
}  // namespace

double longest_m(RoadUserKind kind) {
    if (kind == RoadUserKind::kCar) return kCarLength_m;
    return kind == RoadUserKind::kCyclist ? 1.8 : 0.7;
}

double widest_m(RoadUserKind kind) {
    if (kind == RoadUserKind::kCar) return kCarWidth_m;
    return kind == RoadUserKind::kCyclist ? 0.5 : 0.56;
}

RoadUser makeRoadUser(RoadUserKind kind, std::uint64_t number) {
    Random random{kLooksKey, static_cast<std::uint64_t>(kind), number};
    const Frame frame{{0, 0, 0}, {1, 0}, {0, 1}};
    RoadUser user;
    switch (kind) {
        case RoadUserKind::kCar:
            addCar(user.mesh, frame, random);
            user.footprint = {1.3, 0.75};
            break;
        case RoadUserKind::kCyclist:
            addCyclist(user.mesh, frame, random);
            user.footprint = {0.5, 0.1};
            break;
        case RoadUserKind::kPedestrian:
            addPerson(user.mesh, frame, random.uniform(1.5, 1.9), random);
            user.footprint = {0.2, 0.1};
            break;
    }
    for (const auto& vertex : user.mesh.vertices()) user.box.extend(vertex.cast<double>());
    return user;
}
}  // namespace delio::synth
