#include "room_shell.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace delio::synth {
namespace {
using Eigen::Vector2d;
using Eigen::Vector3d;

/** From south to north between two places on the x axis. */
void addStrip(Mesh& mesh, const Space& space, const Vector2d& from, const Vector2d& to,
              double colour) {
    const double south = space.area.min().y(), north = space.area.max().y();
    mesh.addQuad({from.x(), south, from.y()}, {to.x(), south, to.y()}, {to.x(), north, to.y()},
                 {from.x(), north, from.y()}, colour);
}

/** What floor and ceiling do along x: place and height. */
std::vector<Vector2d> profileOf(const Space& space, bool steps) {
    const auto& flight = space.flight;
    const double west = space.area.min().x(), east = space.area.max().x();
    if (flight.rise_m == 0) return {{west, space.floor_m}, {east, space.floor_m}};
    std::vector<Vector2d> line = {{west, space.floor_m}, {flight.fromX_m, space.floor_m}};
    const double run = flight.toX_m - flight.fromX_m;
    const int count =
        steps ? std::max(1, static_cast<int>(std::lround(run / FloorPlan::kTread_m))) : 0;
    for (int i = 1; i <= count; ++i) {
        const double z = space.floor_m + flight.rise_m * i / count;
        line.emplace_back(flight.fromX_m + run * (i - 1) / count, z);
        line.emplace_back(flight.fromX_m + run * i / count, z);
    }
    if (count == 0) line.emplace_back(flight.toX_m, space.floor_m + flight.rise_m);
    line.emplace_back(east, space.floor_m + flight.rise_m);
    return line;
}

/** Floors, or ceilings `above_m` them. */
void addLevel(Mesh& mesh, const Space& space, bool steps, double above_m, double colour) {
    const auto line = profileOf(space, steps);
    const Vector2d up(0, above_m);
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        addStrip(mesh, space, line[i] + up, line[i + 1] + up, colour);
}

void addWall(Mesh& mesh, const Space& space, Wall wall, double colour) {
    const double rise = space.flight.rise_m;
    const double low = space.floor_m + std::min(0.0, rise);
    const double high = space.floor_m + std::max(0.0, rise) + space.height_m;
    const auto [from, to] = endsOf(space, wall);
    const Frame frame = wallFrame(space, wall, 0);
    const auto band = [&](double u0, double u1, double z0, double z1) {
        if (u1 - u0 < 1e-9 || z1 - z0 < 1e-9) return;
        const double floor = frame.origin.z();
        mesh.addQuad(frame.world(u0, 0, z0 - floor), frame.world(u1, 0, z0 - floor),
                     frame.world(u1, 0, z1 - floor), frame.world(u0, 0, z1 - floor), colour);
    };
    auto doors = space.doors;
    std::sort(doors.begin(), doors.end(),
              [](const Door& a, const Door& b) { return a.middle_m < b.middle_m; });
    double at = from;
    for (const auto& door : doors) {
        if (door.wall != wall) continue;
        const double left = door.middle_m - door.width_m / 2, right = left + door.width_m;
        band(at, left, low, high);
        band(left, right, low, door.floor_m);
        band(left, right, door.floor_m + door.height_m, high);
        at = right;
    }
    band(at, to, low, high);
}

/** The thickness of the wall around an opening. */
void addReveal(Mesh& mesh, const Space& space, const Door& door, double colour) {
    Frame frame = wallFrame(space, door.wall, 0);
    frame.origin.z() = door.floor_m;
    const double left = door.middle_m - door.width_m / 2, right = left + door.width_m;
    const auto slab = [&](double u0, double z0, double u1, double z1) {
        mesh.addQuad(frame.world(u0, 0, z0), frame.world(u1, 0, z1),
                     frame.world(u1, -FloorPlan::kWall_m, z1),
                     frame.world(u0, -FloorPlan::kWall_m, z0), colour);
    };
    slab(left, 0, left, door.height_m);
    slab(right, 0, right, door.height_m);
    slab(left, door.height_m, right, door.height_m);
    slab(left, 0, right, 0);
}
}  // namespace

WallEnds endsOf(const Space& space, Wall wall) {
    const bool alongY = wall == Wall::kWest || wall == Wall::kEast;
    const int axis = alongY ? 1 : 0;
    return {space.area.min()[axis], space.area.max()[axis]};
}

Frame wallFrame(const Space& space, Wall wall, double along_m) {
    const auto& low = space.area.min();
    const auto& high = space.area.max();
    const double east = space.floor_m + space.flight.rise_m;
    switch (wall) {
        case Wall::kWest:
            return {{low.x(), along_m, space.floor_m}, {0, 1}, {1, 0}};
        case Wall::kEast:
            return {{high.x(), along_m, east}, {0, 1}, {-1, 0}};
        case Wall::kSouth:
            return {{along_m, low.y(), space.floor_m}, {1, 0}, {0, 1}};
        default:
            return {{along_m, high.y(), space.floor_m}, {1, 0}, {0, -1}};
    }
}

void addShell(Mesh& mesh, const Space& space, Random& random) {
    const double wall = random.uniform(0.5, 0.75), floor = random.uniform(0.2, 0.45);
    addLevel(mesh, space, space.kind == SpaceKind::kStairs, 0, floor);
    addLevel(mesh, space, false, space.height_m, random.uniform(0.6, 0.8));
    for (const Wall side : {Wall::kWest, Wall::kEast, Wall::kSouth, Wall::kNorth})
        addWall(mesh, space, side, wall);
    for (const auto& door : space.doors)
        if (door.reveals) addReveal(mesh, space, door, 0.5);
}
}  // namespace delio::synth
