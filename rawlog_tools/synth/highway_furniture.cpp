#include "highway_furniture.h"

#include <cmath>

namespace delio::synth {
namespace {
constexpr double kConcrete = 0.4, kSteel = 0.45, kPlate = 0.9;
}

void addBridge(Mesh& mesh, const Frame& frame, double half, Random& random) {
    const double low = random.uniform(4.9, 5.8), width = random.uniform(7, 14);
    const double span = 2 * half;
    mesh.addBox(frame, {0, 0, width, span + 30}, low, low + random.uniform(0.9, 1.5), kConcrete);
    for (const double edge : {-0.5, 0.5})
        mesh.addBox(frame, {edge * width, 0, 0.1, span + 30}, low + 0.9, low + 2.4, kConcrete);
    for (const double row : {-1.0, 0.0, 1.0})
        for (const double along : {-0.3, 0.3})
            mesh.addPost(frame.at(along * width, row * half, 0), 0.45, 0.45, -1.5, low, kConcrete);
    // The banks that carry its ends.
    for (const double end : {-1.0, 1.0})
        mesh.addFrustum(frame, {0, end * (half + 12), width + 12, 20}, -2,
                        {0, end * (half + 14), width, 6}, low, kConcrete);
}

void addGantry(Mesh& mesh, const Frame& frame, double near, double far, Random& random) {
    const double low = random.uniform(5.3, 6), middle = (near + far) / 2;
    for (const double foot : {near, far})
        mesh.addPost(frame.at(0, foot, 0), 0.22, 0.18, -0.5, low + 1.2, kSteel);
    mesh.addBox(frame, {0, middle, 0.35, std::abs(far - near)}, low + 0.5, low + 0.9, kSteel);
    for (double across = 0.2; across < 0.9; across += 0.27) {
        const double v = near + (far - near) * across, height = random.uniform(1, 2);
        mesh.addBox(frame, {-0.3, v, 0.06, random.uniform(1.8, 3)}, low, low + height, kPlate);
    }
}

void addDirectionSign(Mesh& mesh, const Frame& frame, Random& random) {
    const double low = random.uniform(1.2, 2), height = random.uniform(1.5, 3);
    const double width = random.uniform(2, 4);
    for (const double foot : {-0.3, 0.3})
        mesh.addPost(frame.at(0, foot * width, 0), 0.07, 0.07, -0.5, low + height, kSteel);
    mesh.addBox(frame, {-0.12, 0, 0.05, width}, low, low + height, kPlate);
}

void addDelineator(Mesh& mesh, const Frame& frame) {
    mesh.addPost(frame, 0.06, 0.05, -0.3, 1, 0.6);
    mesh.addBox(frame, {0, 0, 0.12, 0.1}, 0.75, 0.9, kPlate);
}

void addPole(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(6.5, 9);
    mesh.addPost(frame, 0.16, 0.11, -0.5, height, 0.25);
    mesh.addBox(frame, {0, 0, 0.12, 1.6}, height - 0.5, height - 0.35, 0.3);
    for (const double v : {-0.6, 0.6})
        mesh.addPost(frame.at(0, v, 0), 0.04, 0.04, height - 0.35, height - 0.15, 0.5);
}
}  // namespace delio::synth
