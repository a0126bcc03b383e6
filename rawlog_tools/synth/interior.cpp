#include "interior.h"

namespace delio::synth {
namespace {
void addLegs(Mesh& mesh, const Frame& frame, double length, double width, double height) {
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
            mesh.addBox(frame, {x * (length - 0.1), y * (width - 0.1), 0.05, 0.05}, 0, height, 0.3);
}

/** Looks along the frame's y axis. */
void addChair(Mesh& mesh, const Frame& frame, Random& random) {
    const double colour = random.uniform(0.15, 0.6);
    addLegs(mesh, frame, 0.45, 0.45, 0.43);
    mesh.addBox(frame, {0, 0, 0.45, 0.45}, 0.43, 0.48, colour);
    mesh.addBox(frame, {0, -0.2, 0.42, 0.05}, 0.55, 0.95, colour);
}
}  // namespace

void addShelf(Mesh& mesh, const Frame& frame, double length, Random& random) {
    constexpr double kBoard = 0.03, kMiddle = kShelfDepth_m / 2;
    const double height = random.uniform(1.6, 2.2), wood = random.uniform(0.3, 0.6);
    const double apart = random.uniform(0.3, 0.42);
    for (const double end : {-0.5, 0.5})
        mesh.addBox(frame, {end * length, kMiddle, kBoard, kShelfDepth_m}, 0, height, wood);
    for (double z = 0.05; z < height; z += apart) {
        mesh.addBox(frame, {0, kMiddle, length, kShelfDepth_m}, z, z + kBoard, wood);
        if (z + apart > height) break;
        for (double u = -length / 2 + 0.05; u < length / 2 - 0.3;) {
            const double wide = random.uniform(0.06, 0.3), deep = random.uniform(0.15, 0.3);
            if (random.chance(0.75))
                mesh.addBox(frame, {u + wide / 2, deep / 2, wide, deep}, z + kBoard,
                            z + apart * random.uniform(0.4, 0.9), random.uniform(0.1, 0.7));
            u += wide + 0.01;
        }
    }
}

void addCabinet(Mesh& mesh, const Frame& frame, double length, Random& random) {
    const double height = random.uniform(0.7, 2.1), colour = random.uniform(0.3, 0.7);
    const double deep = kCabinetDepth_m - 0.05;
    mesh.addBox(frame, {0, deep / 2, length, deep}, 0, height, colour);
    for (double u = -length / 2 + 0.25; u < length / 2; u += 0.5)  // handles
        mesh.addBox(frame, {u, deep + 0.02, 0.03, 0.04}, 0.5 * height, 0.5 * height + 0.15, 0.8);
    if (height < 1.3)
        mesh.addBox(frame, {random.uniform(-0.2, 0.2) * length, 0.25, 0.3, 0.25}, height,
                    height + random.uniform(0.15, 0.4), random.uniform(0.1, 0.7));
}

void addSofa(Mesh& mesh, const Frame& frame, double length, Random& random) {
    const double colour = random.uniform(0.15, 0.6);
    mesh.addBox(frame, {0, 0.45, length, 0.8}, 0.08, 0.42, colour);
    mesh.addFrustum(frame, {0, 0.2, length, 0.25}, 0.42, {0, 0.13, length, 0.18}, 0.85, colour);
    for (const double end : {-0.5, 0.5})
        mesh.addBox(frame, {end * (length - 0.16), 0.45, 0.16, 0.78}, 0.08, 0.6, colour);
}

void addRadiator(Mesh& mesh, const Frame& frame, double length) {
    for (double u = -length / 2; u < length / 2; u += 0.12)
        mesh.addBox(frame, {u, 0.07, 0.06, 0.1}, 0.12, 0.7, 0.75);
    mesh.addBox(frame, {0, 0.05, length, 0.05}, 0.15, 0.67, 0.75);
}

void addBoard(Mesh& mesh, const Frame& frame, double length, Random& random) {
    const double low = random.uniform(0.8, 1.3);
    mesh.addBox(frame, {0, 0.02, length, 0.04}, low, low + random.uniform(0.5, 1.1),
                random.uniform(0.15, 0.9));
}

void addShutDoor(Mesh& mesh, const Frame& frame, double length) {
    for (const double end : {-0.5, 0.5})
        mesh.addBox(frame, {end * length, 0.03, 0.08, 0.06}, 0, 2.08, 0.5);
    mesh.addBox(frame, {0, 0.03, length, 0.06}, 2.02, 2.1, 0.5);
    mesh.addBox(frame, {0, 0.01, length, 0.02}, 0, 2.02, 0.45);
    mesh.addBox(frame, {0.42 * length, 0.06, 0.1, 0.03}, 1.03, 1.06, 0.8);
}

void addTable(Mesh& mesh, const Frame& frame, double length, double width, Random& random) {
    const double high = random.uniform(0.7, 0.78), colour = random.uniform(0.3, 0.7);
    addLegs(mesh, frame, length, width, high);
    mesh.addBox(frame, {0, 0, length, width}, high - 0.04, high, colour);
    for (double u = -length / 2 + 0.4; u < length / 2 - 0.2; u += 0.75)
        for (const double side : {-1.0, 1.0}) {
            if (random.chance(0.7)) {
                const Frame place = frame.at(u, side * (width / 2 + random.uniform(0.1, 0.25)), 0);
                const double back = side > 0 ? 3.1416 : 0;
                addChair(mesh, place.turned(back + random.uniform(-0.4, 0.4)), random);
            }
            if (!random.chance(0.5)) continue;  // a screen, a pile of paper
            const double deep = random.uniform(0.05, 0.25);
            mesh.addBox(frame, {u, side * width / 4, random.uniform(0.2, 0.55), deep}, high,
                        high + random.uniform(0.05, 0.4), random.uniform(0.1, 0.7));
        }
}

void addPillar(Mesh& mesh, const Frame& frame, double height, Random& random) {
    const double thick = random.uniform(0.3, kPillar_m);
    if (random.chance(0.5))
        mesh.addPost(frame, thick / 2, thick / 2, 0, height, 0.6);
    else
        mesh.addBox(frame, {0, 0, thick, thick}, 0, height, 0.6);
}

void addPlant(Mesh& mesh, const Frame& frame, Random& random) {
    const double height = random.uniform(0.7, 1.7);
    mesh.addPost(frame, 0.13, 0.17, 0, 0.35, 0.4);
    mesh.addPost(frame, 0.02, 0.01, 0.35, height, 0.25);
    for (int i = 0; i < 60; ++i)
        mesh.addLeaf(frame.world(0.12 * random.normal(), 0.12 * random.normal(),
                                 random.uniform(0.45, 1) * height),
                     random.uniform(0.05, 0.12), 0.35, random);
}

void addLamp(Mesh& mesh, const Frame& frame, double height, Random& random) {
    const double below = random.uniform(0.03, 0.3);
    mesh.addBox(frame, {0, 0, random.uniform(0.6, 1.5), 0.18}, height - below - 0.07,
                height - below, 0.7);
    mesh.addBox(frame, {0, 0, 0.03, 0.03}, height - below, height, 0.5);
}
}  // namespace delio::synth
