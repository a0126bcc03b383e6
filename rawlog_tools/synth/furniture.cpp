#include "furniture.h"

#include <Eigen/Geometry>
#include <cmath>

namespace delio::synth {
using Eigen::Vector3d;

void addCar(Mesh& mesh, const Frame& frame, Random& random) {
    const double length = random.uniform(3.7, kCarLength_m);
    const double width = random.uniform(1.62, kCarWidth_m);
    const double paint = random.uniform(0.06, 0.6);
    const bool van = random.chance(0.15);
    const double belt = van ? 1.1 : 0.85, roof = van ? random.uniform(1.9, 2.1) : 1.46;
    mesh.addFrustum(frame, {0, 0, length * 0.94, width * 0.93}, 0.2, {0, 0, length, width}, 0.5,
                    paint);
    mesh.addFrustum(frame, {0, 0, length, width}, 0.5, {0, 0, length * 0.93, width * 0.94}, belt,
                    paint);
    // The cabin, with its sloped panes, sits behind the bonnet.
    const double cabin = length * (van ? 0.8 : 0.62), back = length * (van ? 0.06 : 0.08);
    mesh.addFrustum(frame, {-back, 0, cabin, width * 0.9}, belt,
                    {-back - 0.1, 0, cabin * (van ? 0.85 : 0.6), width * 0.75}, roof, 0.08);
    mesh.addBox(frame, {-back - 0.1, 0, cabin * (van ? 0.8 : 0.58), width * 0.7}, roof, roof + 0.03,
                paint);
    for (const double x : {-0.3, 0.3})
        for (const double y : {-0.43, 0.43})
            mesh.addBox(frame, {x * length, y * width, 0.6, 0.18}, 0, 0.6, 0.06);
}

void addTree(Mesh& mesh, const Frame& frame, Random& random) {
    const double trunk = random.uniform(0.1, 0.24), radius = random.uniform(1.3, 2.3);
    const double middle = random.uniform(3.3, 4.2);
    mesh.addPost(frame, trunk * 1.2, trunk * 0.8, -0.3, middle, 0.25);
    const Frame bent = frame.turned(random.uniform(0, 3));
    // Boughs start below the crown.
    for (int i = 0; i < 3; ++i) {
        const Frame bough = bent.turned(2.1 * i);
        mesh.addFrustum(bough, {0.05, 0, 0.1, 0.1}, 1.7, {radius * 0.7, 0, 0.06, 0.06}, middle,
                        0.25);
    }
    const int leaves = static_cast<int>(260 * radius * radius);
    for (int i = 0; i < leaves; ++i) {
        Vector3d d{random.normal(), random.normal(), random.normal()};
        d *= std::cbrt(random.uniform(0.2, 1.0)) / d.norm();
        mesh.addLeaf(frame.world(radius * d.x(), radius * d.y(), middle + radius * 0.95 * d.z()),
                     random.uniform(0.08, 0.2), 0.4, random);
    }
}

void addHedge(Mesh& mesh, const Frame& frame, double length, Random& random) {
    const double height = random.uniform(0.9, 1.8), width = random.uniform(0.5, 0.9);
    // A dense inside, so that nothing is seen through the leaves.
    mesh.addBox(frame, {0, 0, length - 0.1, width - 0.2}, -0.5, height - 0.1, 0.35);
    const int leaves = static_cast<int>(length * 130);
    for (int i = 0; i < leaves; ++i) {
        const double along = random.uniform(-0.5, 0.5) * length;
        const double around = random.uniform(-1, 1);  // down one side, over the top, down the other
        const double bulge = 0.1 * std::sin(along * 2.3) + random.uniform(-0.08, 0.08);
        const double edge = height / (2 * height + width) * 2;
        const double side = std::abs(around) > 1 - edge ? 1 : std::abs(around) / (1 - edge);
        const double w =
            std::abs(around) > 1 - edge ? (1 - std::abs(around)) / edge * height : height + bulge;
        const double v = std::copysign(side * (width / 2 + (side == 1 ? bulge : 0)), around);
        mesh.addLeaf(frame.world(along, v, w), random.uniform(0.06, 0.13), 0.4, random);
    }
}

void addGardenWall(Mesh& mesh, const Frame& frame, double length, Random& random) {
    const double height = random.uniform(0.4, 0.9), colour = random.uniform(0.3, 0.55);
    mesh.addBox(frame, {0, 0, length, 0.24}, -0.5, height, colour);
    for (double u = -length / 2 + 0.2; u < length / 2; u += 1.8)
        mesh.addBox(frame, {u, 0, 0.3, 0.3}, -0.5, height + 0.7, colour);
    mesh.addBox(frame, {0, 0, length, 0.06}, height + 0.5, height + 0.6, 0.3);
}

void addLampPost(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(4.5, 8);
    mesh.addPost(frame, 0.13, 0.11, -0.3, 1.0, 0.4);
    mesh.addPost(frame, 0.08, 0.05, 1.0, height, 0.4);
    mesh.addBox(frame, {0, -0.5, 0.25, 1.2}, height - 0.05, height + 0.1, 0.4);
}

void addSign(Mesh& mesh, const Frame& frame, Random& random) {
    const double low = random.uniform(1.7, 2.2), size = random.uniform(0.45, 0.8);
    mesh.addPost(frame, 0.035, 0.035, -0.3, low + size, 0.5);
    mesh.addBox(frame, {0.06, 0, 0.03, size}, low, low + size, 0.95);
}

void addBin(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(0.9, 1.2);
    mesh.addFrustum(frame, {0, 0, 0.5, 0.5}, 0.05, {0, 0, 0.62, 0.7}, height, 0.2);
    mesh.addFrustum(frame, {0, 0, 0.66, 0.74}, height, {0, 0, 0.5, 0.66}, height + 0.08, 0.25);
}
}  // namespace delio::synth
