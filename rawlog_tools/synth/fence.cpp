#include "fence.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
using Eigen::Vector2d;
using Eigen::Vector3d;

/** At foot `i`: x along the feet, y to their left. */
Frame frameAt(const Feet& feet, std::size_t i) {
    const Vector3d way = feet[std::min(i + 1, feet.size() - 1)] - feet[i > 0 ? i - 1 : 0];
    const Vector2d x = way.head<2>().normalized();
    return {feet[i], x, {-x.y(), x.x()}};
}

/** A strip between (v0, z0) and (v1, z1), across and above the feet. */
void addBand(Mesh& mesh, const Feet& feet, double v0, double z0, double v1, double z1,
             double reflectivity) {
    for (std::size_t i = 0; i + 1 < feet.size(); ++i) {
        const Frame a = frameAt(feet, i), b = frameAt(feet, i + 1);
        mesh.addQuad(a.world(0, v0, z0), b.world(0, v0, z0), b.world(0, v1, z1), a.world(0, v1, z1),
                     reflectivity);
    }
}
}  // namespace

void addFieldFence(Mesh& mesh, const Feet& feet, Random& random) {
    const double height = random.uniform(1, 1.4), colour = random.uniform(0.2, 0.4);
    const int rails = random.chance(0.5) ? 3 : 2;
    for (std::size_t i = 0; i < feet.size(); ++i)
        mesh.addPost(frameAt(feet, i), 0.06, 0.05, -0.4, height + random.uniform(-0.05, 0.1),
                     colour);
    for (int rail = 1; rail <= rails; ++rail) {
        const double z = height * rail / rails - 0.1;
        addBand(mesh, feet, 0.04, z - 0.05, 0.04, z + 0.05, colour);
    }
}

void addStoneWall(Mesh& mesh, const Feet& feet, Random& random) {
    const double height = random.uniform(0.7, 1.2), colour = random.uniform(0.3, 0.5);
    for (const double v : {-0.25, 0.25}) addBand(mesh, feet, v, -0.5, 0.8 * v, height, colour);
    addBand(mesh, feet, -0.2, height, 0.2, height, colour);
    for (std::size_t i = 0; i + 1 < feet.size(); ++i) {
        const Frame frame = frameAt(feet, i);
        const double length = (feet[i + 1] - feet[i]).norm();
        for (int stone = 0; stone < static_cast<int>(10 * length); ++stone) {
            const double face = random.chance(0.5) ? 1 : -1, z = random.uniform(0, height);
            const double bulge = 0.25 - 0.05 * z / height + random.uniform(0, 0.05);
            mesh.addBox(frame, {random.uniform(0, length), face * bulge / 2, 0.3, bulge}, z,
                        std::min(height + 0.05, z + random.uniform(0.1, 0.25)), colour);
        }
    }
}

void addGuardRail(Mesh& mesh, const Feet& feet, bool right) {
    constexpr double kSteel = 0.45;
    // The W, from its lower edge up.
    constexpr double kSection[][2] = {{0, 0.44},    {0.08, 0.5}, {0.08, 0.55}, {0, 0.6},
                                      {0.08, 0.65}, {0.08, 0.7}, {0, 0.76}};
    const double side = right ? -1 : 1;
    for (std::size_t i = 0; i + 1 < std::size(kSection); ++i)
        addBand(mesh, feet, side * kSection[i][0], kSection[i][1], side * kSection[i + 1][0],
                kSection[i + 1][1], kSteel);
    for (std::size_t i = 0; i + 1 < feet.size(); ++i)
        mesh.addBox(frameAt(feet, i), {0, side * -0.08, 0.06, 0.12}, -0.5, 0.72, kSteel);
}

void addNoiseWall(Mesh& mesh, const Feet& feet, double height) {
    constexpr double kPanel = 0.35;
    addBand(mesh, feet, 0, -1, 0, height, kPanel);
    addBand(mesh, feet, 0, height, 0.15, height, kPanel);
    for (std::size_t i = 0; i < feet.size(); ++i)
        mesh.addBox(frameAt(feet, i), {0, 0, 0.2, 0.24}, -1, height + 0.05, 0.4);
}
}  // namespace delio::synth
