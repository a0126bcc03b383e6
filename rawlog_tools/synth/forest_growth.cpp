#include "forest_growth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
using Eigen::Vector3d;
constexpr double kTurn = 2 * 3.14159265358979323846, kBark = 0.22;

/** A straight piece of wood. */
void addLimb(Mesh& mesh, const Vector3d& from, const Vector3d& to, double radiusFrom,
             double radiusTo, int sides) {
    const Vector3d along = (to - from).normalized();
    const Vector3d u = along.unitOrthogonal(), v = along.cross(u);
    const auto corner = [&](const Vector3d& end, double radius, int i) -> Vector3d {
        const double angle = kTurn * i / sides;
        return end + radius * (std::cos(angle) * u + std::sin(angle) * v);
    };
    for (int i = 0; i < sides; ++i)
        mesh.addQuad(corner(from, radiusFrom, i), corner(from, radiusFrom, i + 1),
                     corner(to, radiusTo, i + 1), corner(to, radiusTo, i), kBark);
}

void addFoliage(Mesh& mesh, const Vector3d& centre, double spread, int leaves, double green,
                Random& random) {
    for (int i = 0; i < leaves; ++i) {
        const Vector3d off(random.normal(), random.normal(), 0.7 * random.normal());
        mesh.addLeaf(centre + spread * off, random.uniform(0.06, 0.22), green, random);
    }
}

/** The middle line of a trunk, its foot below the ground. */
struct Stem {
    Vector3d foot, bend, top;
    Vector3d at(double share) const {
        return share < 0.5 ? foot + 2 * share * (bend - foot)
                           : bend + (2 * share - 1) * (top - bend);
    }
};

void addBranch(Mesh& mesh, const Frame& frame, const Stem& stem, double share,
               const ForestTree& tree, Random& random) {
    const Vector3d from = stem.at(share);
    const double up = from.z() - frame.origin.z(), around = random.uniform(0, kTurn);
    double length = random.uniform(0.5, tree.conifer ? 2.6 * (1.15 - share) : 2.4);
    if (up < kFree_m + 1) length = std::min(length, tree.lowReach_m);
    if (length < 0.2) return;
    const double rise = tree.conifer ? random.uniform(-0.35, 0.1) : random.uniform(0, 0.7);
    const Vector3d reach(std::cos(around), std::sin(around), rise);
    const Vector3d to = from + length * reach;
    addLimb(mesh, from, to, random.uniform(0.015, 0.045), 0.008, 3);
    const bool dead = up < 2.5 ? random.chance(0.6) : random.chance(0.15);
    if (dead) return;
    const int leaves = tree.dense ? 8 : 4;
    for (const double out : {0.6, 1.0})
        addFoliage(mesh, from + out * length * reach, 0.14, leaves, 0.35, random);
}
}  // namespace

void addForestTree(Mesh& mesh, const Frame& frame, const ForestTree& tree, Random& random) {
    const double height = random.uniform(8, 17), radius = tree.diameter_m / 2;
    const auto lean = [&](double up, double share) {
        return frame.world(share * up * random.normal(), share * up * random.normal(), up);
    };
    const Stem stem{frame.world(0, 0, -0.4), lean(height / 2, 0.02), lean(height, 0.025)};
    addLimb(mesh, stem.foot, stem.bend, radius * 1.08, radius * 0.75, 9);
    addLimb(mesh, stem.bend, stem.top, radius * 0.75, 0.03, 7);
    for (int i = 0; i < 3; ++i) {  // roots
        const Frame root = frame.turned(kTurn / 3 * i + random.uniform(0, 1));
        addLimb(mesh, root.world(0, 0, 0.3), root.world(radius * random.uniform(2, 4), 0, -0.15),
                radius * 0.6, radius * 0.3, 4);
    }
    const int branches = static_cast<int>(random.uniform(9, 16)) / (tree.dense ? 1 : 2);
    for (int i = 0; i < branches; ++i)
        addBranch(mesh, frame, stem, random.uniform(0.12, 0.95), tree, random);
    const int crown = tree.dense ? 70 : 30;
    addFoliage(mesh, stem.at(tree.conifer ? 0.75 : 0.85), tree.conifer ? 0.7 : 1.1, crown, 0.35,
               random);
}

void addSapling(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(1, 3), away = random.uniform(-0.3, 0.3);
    addLimb(mesh, frame.world(0, 0, -0.2), frame.world(away, 0, height), 0.02, 0.008, 4);
    for (double share = 0.35; share < 1; share += 0.15)
        addFoliage(mesh, frame.world(share * away, 0, share * height), 0.16, 6, 0.4, random);
}

void addFern(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(0.3, 0.8);
    for (int i = 0; i < 9; ++i) {
        const Frame frond = frame.turned(random.uniform(0, kTurn));
        const double reach = random.uniform(0.3, 0.7);
        for (const double out : {0.35, 0.7, 1.0})
            mesh.addLeaf(frond.world(out * reach, 0, height * out * (1.6 - out)),
                         random.uniform(0.06, 0.14), 0.4, random);
    }
}

void addStump(Mesh& mesh, const Frame& frame, Random& random) {
    const double radius = random.uniform(0.12, 0.28), height = random.uniform(0.25, 0.7);
    mesh.addPost(frame, radius * 1.4, radius, -0.3, height, kBark);
    mesh.addBox(frame, {0, 0, radius * 1.3, radius * 1.3}, height - 0.03, height, 0.4);
}

void addLog(Mesh& mesh, const Frame& frame, Random& random) {
    const double half = random.uniform(1, kLog_m / 2), radius = random.uniform(0.08, 0.2);
    addLimb(mesh, frame.world(-half, 0, random.uniform(0, 0.3)),
            frame.world(half, 0, random.uniform(0, 0.3)), radius, radius * 0.6, 8);
    for (int i = 0; i < 4; ++i) {
        const Vector3d from = frame.world(half * random.uniform(-0.8, 0.8), 0, 0.2);
        addLimb(mesh, from, from + Vector3d(random.normal(), random.normal(), 1) * 0.4, 0.02, 0.008,
                3);
    }
}
}  // namespace delio::synth
