#include "vegetation.h"

#include <cmath>

namespace delio::synth {
namespace {
using Eigen::Vector3d;

/** Evenly over the ball of radius 1, denser towards its surface. */
Vector3d inBall(Random& random) {
    const Vector3d d{random.normal(), random.normal(), random.normal()};
    return d * std::cbrt(random.uniform(0.25, 1.0)) / d.norm();
}
}  // namespace

void addBush(Mesh& mesh, const Frame& frame, Random& random) {
    const double radius = random.uniform(0.5, 1.3), height = radius * random.uniform(0.9, 1.5);
    const double green = random.uniform(0.3, 0.45);
    // Nothing is seen through its middle.
    mesh.addPost(frame, 0.6 * radius, 0.3 * radius, -0.3, 0.7 * height, green - 0.1);
    const int leaves = static_cast<int>(150 * radius * radius);
    for (int i = 0; i < leaves; ++i) {
        const Vector3d d = inBall(random);
        mesh.addLeaf(frame.world(radius * d.x(), radius * d.y(), height * (0.45 + 0.55 * d.z())),
                     random.uniform(0.06, 0.16), green, random);
    }
}

void addTallTree(Mesh& mesh, const Frame& frame, Random& random) {
    const double trunk = random.uniform(0.15, 0.35), radius = random.uniform(2, 3.8);
    const double low = random.uniform(1.6, 3), high = low + radius * random.uniform(1.7, 2.6);
    const double middle = (low + high) / 2, green = random.uniform(0.32, 0.45);
    mesh.addPost(frame, trunk * 1.3, trunk * 0.7, -0.5, middle, 0.25);
    for (int i = 0; i < 4; ++i) {
        const Frame bough = frame.turned(1.6 * i + random.uniform(0, 1));
        mesh.addFrustum(bough, {0, 0, 0.16, 0.16}, low, {radius * 0.6, 0, 0.08, 0.08}, middle,
                        0.25);
    }
    const int leaves = static_cast<int>(75 * radius * radius);
    for (int i = 0; i < leaves; ++i) {
        const Vector3d d = inBall(random);
        mesh.addLeaf(frame.world(radius * d.x(), radius * d.y(), middle + (high - low) / 2 * d.z()),
                     random.uniform(0.14, 0.36), green, random);
    }
}

void addConifer(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(6, 16), radius = height * random.uniform(0.16, 0.24);
    const double foot = random.uniform(0.3, 1.5), green = random.uniform(0.25, 0.38);
    mesh.addPost(frame, 0.2, 0.03, -0.5, height, 0.2);
    const int leaves = static_cast<int>(55 * radius * height / 2);
    for (int i = 0; i < leaves; ++i) {
        const double up = 1 - std::sqrt(random.uniform());  // 0 at the foot; fewer at the top
        const double around = random.uniform(0, 6.2831853), out = std::sqrt(random.uniform());
        const double reach = radius * (1 - up) * out * (0.85 + 0.15 * std::sin(40 * up));
        mesh.addLeaf(frame.world(reach * std::cos(around), reach * std::sin(around),
                                 foot + (height - foot) * up),
                     random.uniform(0.12, 0.3), green, random);
    }
}

void addGrass(Mesh& mesh, const Frame& frame, double length, double width, Random& random) {
    const double height = random.uniform(0.1, 0.45), green = random.uniform(0.35, 0.5);
    const int tufts = static_cast<int>(3 * length * width);
    for (int i = 0; i < tufts; ++i)
        mesh.addLeaf(
            frame.world(random.uniform(-0.5, 0.5) * length, random.uniform(-0.5, 0.5) * width,
                        height * random.uniform(-0.1, 0.8)),
            random.uniform(0.06, 0.16), green, random);
}
}  // namespace delio::synth
