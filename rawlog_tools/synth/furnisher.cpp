#include "furnisher.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "interior.h"
#include "room_shell.h"

namespace delio::synth {
namespace {
using Eigen::Vector2d;

/** Objects that stand or hang at a wall. */
struct Piece {
    double shortest_m, longest_m, depth_m;
    void (*add)(Mesh& mesh, const Frame& frame, double length, Random& random);
};

// Flat ones first: corridors have no others.
constexpr std::size_t kFlat = 3;
const std::array<Piece, 6> kPieces = {{
    {0.85, 0.95, kFlatDepth_m,
     [](Mesh& m, const Frame& f, double length, Random&) { addShutDoor(m, f, length); }},
    {0.6, 2, kFlatDepth_m, addBoard},
    {0.6, 1.8, kFlatDepth_m,
     [](Mesh& m, const Frame& f, double length, Random&) { addRadiator(m, f, length); }},
    {0.8, 2.4, kShelfDepth_m, addShelf},
    {0.6, 2, kCabinetDepth_m, addCabinet},
    {1.4, 2.2, kSofaDepth_m, addSofa},
}};

/** Of a rectangle, as the world's axes have it. */
Eigen::AlignedBox2d boxOf(const Frame& frame, double length, double width) {
    Eigen::AlignedBox2d box;
    for (const double u : {-0.5, 0.5})
        for (const double v : {-0.5, 0.5})
            box.extend(Vector2d(frame.world(u * length, v * width, 0).head<2>()));
    return box;
}
}  // namespace

void Furnisher::furnish() {
    const bool flight = space_.flight.rise_m != 0;
    for (const Wall wall : {Wall::kWest, Wall::kEast, Wall::kSouth, Wall::kNorth})
        if (!flight) lineWall(wall);
    if (space_.kind == SpaceKind::kRoom) {
        addPillars();
        fillMiddle();
    }
    if (!flight) hangLamps();
}

void Furnisher::lineWall(Wall wall) {
    const auto [from, to] = endsOf(space_, wall);
    const bool room = space_.kind == SpaceKind::kRoom;
    for (double at = from + random_.uniform(0.1, 1); at < to - 0.8;) {
        const auto count = static_cast<double>(room ? kPieces.size() : kFlat);
        const Piece& piece = kPieces[static_cast<std::size_t>(random_.uniform(0, count))];
        const double longest = std::min(piece.longest_m, to - at - 0.1);
        const double length = random_.uniform(std::min(piece.shortest_m, longest), longest);
        const Frame frame = wallFrame(space_, wall, at + length / 2);
        if (length >= piece.shortest_m &&
            take(frame.at(0, piece.depth_m / 2, 0), length, piece.depth_m))
            piece.add(mesh_, frame, length, random_);
        at += length + random_.uniform(0.1, room ? 1.5 : 3);
    }
}

void Furnisher::addPillars() {
    const Vector2d size = space_.area.sizes(), low = space_.area.min();
    if (size.minCoeff() < 6.5) return;
    for (const double u : {1 / 3.0, 2 / 3.0})
        for (const double v : {1 / 3.0, 2 / 3.0}) {
            const Frame frame{
                {low.x() + u * size.x(), low.y() + v * size.y(), space_.floor_m}, {1, 0}, {0, 1}};
            if (take(frame, kPillar_m, kPillar_m))
                addPillar(mesh_, frame, space_.height_m, random_);
        }
}

void Furnisher::fillMiddle() {
    const Vector2d size = space_.area.sizes(), low = space_.area.min();
    const int tries = static_cast<int>(size.prod() / 4);
    for (int i = 0; i < tries; ++i) {
        const Vector2d place = low + Vector2d(random_.uniform(0.5, size.x() - 0.5),
                                              random_.uniform(0.5, size.y() - 0.5));
        const Frame frame{{place.x(), place.y(), space_.floor_m}, {1, 0}, {0, 1}};
        const Frame turned = random_.chance(0.5) ? frame : frame.turned(1.5707963);
        const double length = random_.uniform(0.8, 2.2), width = random_.uniform(0.6, 1);
        const bool plant = random_.chance(0.2);
        if (plant && take(frame, 0.6, 0.6))
            addPlant(mesh_, frame, random_);
        else if (!plant && take(turned, length + 0.2, width + 2 * kChair_m))
            addTable(mesh_, turned, length, width, random_);
    }
}

void Furnisher::hangLamps() {
    constexpr double kApart_m = 2.4;
    const Vector2d size = space_.area.sizes(), low = space_.area.min();
    const int columns = std::max(1, static_cast<int>(size.x() / kApart_m));
    const int rows = std::max(1, static_cast<int>(size.y() / kApart_m));
    const bool along = random_.chance(0.5) || rows == 1;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            if (random_.chance(0.3)) continue;
            const Frame frame{{low.x() + size.x() * (i + 0.5) / columns,
                               low.y() + size.y() * (j + 0.5) / rows, space_.floor_m},
                              {1, 0},
                              {0, 1}};
            addLamp(mesh_, along ? frame : frame.turned(1.5707963), space_.height_m, random_);
        }
}

bool Furnisher::take(const Frame& frame, double length, double width) {
    const auto box = boxOf(frame, length, width);
    // Something at a wall may stick into it by a rounding.
    Eigen::AlignedBox2d inner(space_.area.min().array() - 1e-6, space_.area.max().array() + 1e-6);
    if (!inner.contains(box) || isAtDoor(box) || isInTheWay(box)) return false;
    for (const auto& other : taken_)
        if (!box.intersection(other).isEmpty()) return false;
    taken_.push_back(box);
    return true;
}

bool Furnisher::isInTheWay(const Eigen::AlignedBox2d& box) const {
    constexpr double kStep_m = 0.15;
    for (double x = box.min().x(); x < box.max().x() + kStep_m; x += kStep_m)
        for (double y = box.min().y(); y < box.max().y() + kStep_m; y += kStep_m) {
            const Vector2d place = Vector2d(x, y).cwiseMin(box.max());
            if (road_.distanceToVehicle(place, 1) < kClear_m) return true;
        }
    return false;
}

bool Furnisher::isAtDoor(const Eigen::AlignedBox2d& box) const {
    for (const auto& door : space_.doors) {
        const Eigen::Vector3d place = wallFrame(space_, door.wall, door.middle_m).origin;
        if (box.exteriorDistance(Vector2d(place.head<2>())) < door.width_m / 2 + 0.1) return true;
    }
    return false;
}
}  // namespace delio::synth
