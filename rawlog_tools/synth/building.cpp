#include "building.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
constexpr double kFoundation_m = -1.5;  // deep enough for the slope of the ground
constexpr double kGlass = 0.06;

struct Bay {
    double u0, u1, w0, w1;             // of the piece of wall
    double left, right, sill, lintel;  // of the opening in it
    double recess, glass;
};

/** A piece of wall with a recessed opening. */
void addBay(Mesh& mesh, const Frame& frame, const Bay& b, double wall) {
    const auto at = [&](double u, double w, double v) { return frame.world(u, v, w); };
    const auto band = [&](double u0, double u1, double w0, double w1, double v, double colour) {
        mesh.addQuad(at(u0, w0, v), at(u1, w0, v), at(u1, w1, v), at(u0, w1, v), colour);
    };
    band(b.u0, b.left, b.w0, b.w1, 0, wall);
    band(b.right, b.u1, b.w0, b.w1, 0, wall);
    band(b.left, b.right, b.w0, b.sill, 0, wall);
    band(b.left, b.right, b.lintel, b.w1, 0, wall);
    band(b.left, b.right, b.sill, b.lintel, b.recess, b.glass);
    const double corners[][2] = {
        {b.left, b.sill}, {b.right, b.sill}, {b.right, b.lintel}, {b.left, b.lintel}};
    for (int i = 0; i < 4; ++i) {
        const auto& p = corners[i];
        const auto& q = corners[(i + 1) % 4];
        mesh.addQuad(at(p[0], p[1], 0), at(q[0], q[1], 0), at(q[0], q[1], b.recess),
                     at(p[0], p[1], b.recess), wall);
    }
}

/** A slab with a parapet on three sides, hanging on the front. */
void addBalcony(Mesh& mesh, const Frame& frame, double u, double width, double floor,
                double colour) {
    constexpr double kReach = 0.9, kParapet = 0.95;
    const Frame place = frame.at(u, 0, floor);
    mesh.addBox(place, {0, -kReach / 2, width, kReach}, -0.15, 0, colour);
    mesh.addBox(place, {0, -kReach, width, 0.08}, 0, kParapet, colour);
    for (const double end : {-0.5, 0.5})
        mesh.addBox(place, {end * width, -kReach / 2, 0.08, kReach}, 0, kParapet, colour);
}

/** Steps before a door, or a bay window. */
void addGroundFloorExtra(Mesh& mesh, const Frame& frame, const Bay& b, bool door, double colour,
                         Random& random) {
    const double middle = (b.left + b.right) / 2, width = b.right - b.left;
    if (door) {
        mesh.addBox(frame, {middle, -0.3, width + 0.4, 0.6}, -0.5, 0.17, 0.35);
        if (random.chance(0.5)) mesh.addBox(frame, {middle, -0.4, width + 0.6, 0.8}, 2.3, 2.4, 0.4);
    } else if (random.chance(0.12)) {
        mesh.addFrustum(frame, {middle, -0.25, width, 0.5}, 0.2, {middle, -0.2, width - 0.3, 0.4},
                        b.lintel, colour);
    }
}

void addFront(Mesh& mesh, const Frame& frame, double width, int floors, double floorHeight,
              double wall, Random& random) {
    const int bays = std::max(1, static_cast<int>(width / random.uniform(2.4, 3.4)));
    const double bayWidth = width / bays, openingWidth = bayWidth * random.uniform(0.38, 0.6);
    const double recess = random.uniform(0.12, 0.3);
    const int doorBay = static_cast<int>(random.uniform(0, bays));
    const int balconyEvery = random.chance(0.5) ? 2 : 1000;
    mesh.addQuad(frame.world(0, 0, kFoundation_m), frame.world(width, 0, kFoundation_m),
                 frame.world(width, 0, 0), frame.world(0, 0, 0), wall);
    for (int floor = 0; floor < floors; ++floor) {
        for (int bay = 0; bay < bays; ++bay) {
            const bool door = floor == 0 && bay == doorBay;
            Bay b{};
            b.u0 = bay * bayWidth;
            b.u1 = b.u0 + bayWidth;
            b.w0 = floor * floorHeight;
            b.w1 = b.w0 + floorHeight;
            b.left = b.u0 + (bayWidth - openingWidth) / 2;
            b.right = b.left + openingWidth;
            b.sill = b.w0 + (door ? 0.15 : 0.9);
            b.lintel = b.w0 + 2.25;
            b.recess = recess + (door ? 0.15 : 0);
            // Curtains and blinds: behind many panes something gives an echo.
            b.glass = door ? 0.3 : random.chance(0.5) ? 0.25 : kGlass;
            addBay(mesh, frame, b, wall);
            if (floor == 0) addGroundFloorExtra(mesh, frame, b, door, wall, random);
            if (floor > 0 && bay % balconyEvery == 1)
                addBalcony(mesh, frame, (b.u0 + b.u1) / 2, bayWidth * 0.8, b.w0, wall);
        }
    }
}

void addRoof(Mesh& mesh, const Frame& frame, double width, double depth, double eaves,
             Random& random) {
    if (random.chance(0.3))
        return mesh.addBox(frame, {width / 2, depth / 2, width + 0.3, depth + 0.3}, eaves,
                           eaves + 0.4, 0.2);
    const double ridge = eaves + depth * random.uniform(0.25, 0.5);
    mesh.addFrustum(frame, {width / 2, depth / 2, width + 0.4, depth + 0.8}, eaves - 0.2,
                    {width / 2, depth / 2, width + 0.4, 0.05}, ridge, 0.2);
}
}  // namespace

void addBuilding(Mesh& mesh, const Frame& frame, double width, double depth, Random& random,
                 int mostFloors) {
    const double wall = random.uniform(0.3, 0.65);
    const double floorHeight = random.uniform(2.8, 3.3);
    const int floors = static_cast<int>(random.uniform(2, mostFloors + 1));
    const double eaves = floors * floorHeight;
    const Frame raised = frame.at(0, 0, random.uniform(0, 0.5));
    addFront(mesh, raised, width, floors, floorHeight, wall, random);
    const auto side = [&](double u0, double v0, double u1, double v1) {
        mesh.addQuad(raised.world(u0, v0, kFoundation_m), raised.world(u1, v1, kFoundation_m),
                     raised.world(u1, v1, eaves), raised.world(u0, v0, eaves), wall);
    };
    side(0, 0, 0, depth);
    side(width, 0, width, depth);
    side(0, depth, width, depth);
    addRoof(mesh, raised, width, depth, eaves, random);
    if (random.chance(0.4))  // pilasters
        for (const double u : {0.15, width - 0.15})
            mesh.addBox(raised, {u, 0, 0.3, 0.3}, kFoundation_m, eaves, wall);
    if (random.chance(0.7))  // a rainwater pipe
        mesh.addPost(raised.at(random.uniform(0.4, 0.8), -0.08, 0), 0.06, 0.06, kFoundation_m,
                     eaves, 0.4);
}

void addBlock(Mesh& mesh, const Frame& frame, double width, double depth, Random& random) {
    const double eaves = random.uniform(5, 14), wall = random.uniform(0.25, 0.6);
    mesh.addBox(frame, {width / 2, depth / 2, width, depth}, kFoundation_m, eaves, wall);
    addRoof(mesh, frame, width, depth, eaves, random);
}
}  // namespace delio::synth
