#include "floor_plan.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
using Eigen::Vector2d;
constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kPlanKey = 0xF100;
constexpr double kSmallest_m = 4, kLargest_m = 11;  // of a room; the walk may need a little more
constexpr double kAside_m = 1.3;                    // from the walk to a wall beside it
constexpr double kEase_m = 0.5, kArc_m = 1;         // of a turn, at both ends and in between
constexpr double kStair_m = 0.16, kRunOfRamp = 7, kLanding_m = 1.25;

/** A length that the walk can go. */
double steps(double low, double high, Random& random) {
    return Walk::kStep_m * std::floor(random.uniform(low, high) / Walk::kStep_m);
}
double stepsUpTo(double length_m) {
    return Walk::kStep_m * std::ceil(std::max(0.0, length_m) / Walk::kStep_m);
}

std::vector<CurvaturePiece> turnPieces(int side) {
    const double curvature = side * kPi / 2 / (kEase_m + kArc_m);
    return {{kEase_m, curvature}, {kArc_m, curvature}, {kEase_m, 0}};
}

Eigen::AlignedBox2d between(const Vector2d& a, const Vector2d& b) {
    return Eigen::AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b));
}

Wall opposite(Wall wall) {
    switch (wall) {
        case Wall::kWest:
            return Wall::kEast;
        case Wall::kEast:
            return Wall::kWest;
        case Wall::kSouth:
            return Wall::kNorth;
        default:
            return Wall::kSouth;
    }
}
}  // namespace

Wall Walk::ahead() const {
    if (std::abs(ahead_.x()) > 0.5) return ahead_.x() > 0 ? Wall::kEast : Wall::kWest;
    return ahead_.y() > 0 ? Wall::kNorth : Wall::kSouth;
}

void Walk::go(double length_m) {
    if (length_m <= 0) return;
    pieces_.push_back({length_m, 0});
    s_ += length_m;
    place_ += length_m * ahead_;
}

void Walk::turn(int side) {
    const auto pieces = turnPieces(side);
    // As the path will have it: its arcs are made of short straight ones.
    const Station end = Path(0, pieces).at(2 * kEase_m + kArc_m);
    const Vector2d left(-ahead_.y(), ahead_.x());
    place_ += end.x * ahead_ + end.y * left;
    ahead_ = side * left;
    s_ += end.s;
    pieces_.insert(pieces_.end(), pieces.begin(), pieces.end());
}

FloorPlan::FloorPlan(std::uint64_t seed, double length_m) : walk_(-kHall_m - kWall_m - 2) {
    Random first{seed, kPlanKey};
    last_ = {Wall::kEast, 0, 0, 0, 0, false};
    addCorridor(kHall_m, first);
    addRoom(2, first);
    for (std::uint64_t column = 0; walk_.s() < length_m; ++column) {
        Random random{seed, kPlanKey, column + 1};
        switch (column % 4) {
            case 0:
                addCorridor(steps(5, 12, random), random);
                break;
            case 1:
                addTurn(random);
                break;
            case 2:
                addFlight(random);
                break;
            default:
                random.chance(0.5) ? addRoom(0, random) : addTurn(random);
        }
    }
}

std::vector<RoadProfile::Ramp> FloorPlan::ramps() const {
    std::vector<RoadProfile::Ramp> ramps;
    for (const auto& space : spaces_)
        if (space.flight.rise_m != 0) ramps.push_back(space.flight);
    return ramps;
}

Space FloorPlan::enter(SpaceKind kind, Random& random) const {
    Space space;
    space.kind = kind;
    space.begin_s = walk_.s();
    space.floor_m = level_m_;
    space.height_m = random.uniform(2.5, kind == SpaceKind::kCorridor ? 3.0 : 3.5);
    if (last_.width_m == 0) return space;  // the hall, where nobody comes from
    space.doors.push_back(last_);
    space.doors.back().wall = opposite(walk_.ahead());
    space.doors.back().reveals = false;
    return space;
}

void FloorPlan::leave(Space& space, Random& random) {
    const Wall wall = walk_.ahead();
    const bool east = wall == Wall::kEast;
    last_ = {wall,
             east ? walk_.y() : walk_.x(),
             random.uniform(0.95, 1.5),
             random.uniform(2, 2.25),
             level_m_,
             true};
    space.doors.push_back(last_);
    spaces_.push_back(space);
    walk_.go(kWall_m);
}

void FloorPlan::addCorridor(double length_m, Random& random) {
    Space corridor = enter(SpaceKind::kCorridor, random);
    const double half = random.uniform(0.9, 1.3), west = walk_.x();
    walk_.go(length_m);
    corridor.area = between({west, walk_.y() - half}, {walk_.x(), walk_.y() + half});
    const auto index = spaces_.size();
    leave(corridor, random);
    for (const double side : {-1.0, 1.0})
        if (length_m >= 5 && random.chance(0.6)) addSideRoom(index, side, random);
}

void FloorPlan::addSideRoom(std::size_t index, double side, Random& random) {
    const Space& corridor = spaces_[index];
    const double wide = random.uniform(kSmallest_m, std::min(9.0, corridor.area.sizes().x()));
    const double deep = random.uniform(kSmallest_m, 7);
    const double west = random.uniform(corridor.area.min().x(), corridor.area.max().x() - wide);
    const double wall = side > 0 ? corridor.area.max().y() : corridor.area.min().y();
    const double near = wall + side * kWall_m;
    Space room;
    room.begin_s = corridor.begin_s;
    room.floor_m = corridor.floor_m;
    room.height_m = random.uniform(2.5, 3.5);
    room.area = between({west, near}, {west + wide, near + side * deep});
    Door door{side > 0 ? Wall::kSouth : Wall::kNorth,
              west + wide * random.uniform(0.25, 0.75),
              random.uniform(0.85, 1),
              2.05,
              room.floor_m,
              false};
    room.doors.push_back(door);
    door.wall = opposite(door.wall);
    door.reveals = true;
    spaces_[index].doors.push_back(door);
    spaces_.push_back(room);
}

void FloorPlan::addRoom(double lead_m, Random& random) {
    Space room = enter(SpaceKind::kRoom, random);
    const Vector2d begin(walk_.x(), walk_.y());
    walk_.go(lead_m + steps(1, 3, random));
    if (random.chance(0.6)) {  // from one side of the room to the other
        const int side = random.chance(0.5) ? 1 : -1;
        walk_.turn(side);
        walk_.go(steps(0, 3, random));
        walk_.turn(-side);
    }
    walk_.go(steps(1, 3, random));
    walk_.go(stepsUpTo(begin.x() + kSmallest_m - walk_.x()));
    const double low = std::min(begin.y(), walk_.y()), span = std::abs(walk_.y() - begin.y());
    const double deep = random.uniform(std::max(kSmallest_m, span + 2 * kAside_m), kLargest_m);
    const double south = low - random.uniform(kAside_m, deep - span - kAside_m);
    room.area = between({begin.x(), south}, {walk_.x(), south + deep});
    leave(room, random);
}

void FloorPlan::addTurn(Random& random) {
    const int side = random.chance(0.5) ? 1 : -1;
    const double west = walk_.x();
    Space first = enter(SpaceKind::kRoom, random);
    const double near = walk_.y() - side * random.uniform(2, 5);
    walk_.go(steps(1, 3, random));
    walk_.turn(side);
    const double way = walk_.x();
    walk_.go(steps(1, 5, random));
    const double wide = random.uniform(std::max(kSmallest_m, way - west + kAside_m), kLargest_m);
    first.area = between({west, near}, {west + wide, walk_.y()});
    leave(first, random);
    if (random.chance(0.5)) addPassage(random);

    Space last = enter(SpaceKind::kRoom, random);
    const double from = walk_.y(), left = way - random.uniform(kAside_m, way - west);
    walk_.go(steps(1, 3, random));
    walk_.turn(-side);
    const double far = walk_.y() + side * random.uniform(2, 5);
    // Its east wall ends the column: nothing of the column reaches beyond.
    const double east = std::max({west + wide, left + kSmallest_m, walk_.x() + 0.75});
    walk_.go(stepsUpTo(east - walk_.x()));
    last.area = between({left, from}, {walk_.x(), far});
    leave(last, random);
}

void FloorPlan::addPassage(Random& random) {
    Space passage = enter(SpaceKind::kCorridor, random);
    const double half = random.uniform(0.9, 1.3), from = walk_.y();
    walk_.go(steps(3, 8, random));
    passage.area = between({walk_.x() - half, from}, {walk_.x() + half, walk_.y()});
    leave(passage, random);
}

void FloorPlan::addFlight(Random& random) {
    const bool up = level_m_ == 0, steep = random.chance(0.6);
    const double high =
        up ? kStair_m * std::floor(steep ? random.uniform(9, 17) : random.uniform(5, 9)) : level_m_;
    const bool stairs = steep || high > 1.3;  // a ramp would be too long
    const double run = stairs ? kTread_m * std::round(high / kStair_m) : kRunOfRamp * high;
    Space space = enter(stairs ? SpaceKind::kStairs : SpaceKind::kRamp, random);
    const double half = random.uniform(0.9, 1.3), west = walk_.x();
    walk_.go(stepsUpTo(run + 2 * kLanding_m));
    space.area = between({west, walk_.y() - half}, {walk_.x(), walk_.y() + half});
    space.flight = {west + kLanding_m, west + kLanding_m + run, up ? high : -high};
    level_m_ = up ? high : 0;
    leave(space, random);
}
}  // namespace delio::synth
