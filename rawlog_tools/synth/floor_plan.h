#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "path.h"
#include "random.h"
#include "road_profile.h"

namespace delio::synth {
enum class SpaceKind { kRoom, kCorridor, kStairs, kRamp };
enum class Wall { kWest, kEast, kSouth, kNorth };

/** An opening in a wall. */
struct Door {
    Wall wall = Wall::kWest;
    double middle_m = 0;  //!< along the wall: the world's x or y
    double width_m = 0, height_m = 0, floor_m = 0;
    bool reveals = false;  //!< to its space belongs the thickness of the wall
};

/** A room, a corridor, or a way between two levels. */
struct Space {
    SpaceKind kind = SpaceKind::kRoom;
    Eigen::AlignedBox2d area;  //!< between the walls
    double floor_m = 0;        //!< in the west
    double height_m = 0;       //!< from the floor to the ceiling
    RoadProfile::Ramp flight{};
    std::vector<Door> doors;
    double begin_s = 0;  //!< where the walk enters it, or passes its door
};

/** A walk of a straight line with turns of 90 deg. */
class Walk {
 public:
    static constexpr double kStep_m = 0.25;  //!< of the path: lengths are multiples of it

    explicit Walk(double begin_s) : begin_s_(begin_s), s_(begin_s), place_(begin_s, 0) {}
    double s() const { return s_; }
    double x() const { return place_.x(); }
    double y() const { return place_.y(); }
    Wall ahead() const;
    void go(double length_m);
    /** `side` +1: to the left. */
    void turn(int side);
    Path path() const { return Path(begin_s_, pieces_); }

 private:
    double begin_s_, s_;
    Eigen::Vector2d place_;
    Eigen::Vector2d ahead_{1, 0};
    std::vector<CurvaturePiece> pieces_;
};

/** Rooms of 4 to 12 m, corridors and flights, and a walk through their doors that never comes back.
 *  The house is made of columns, the one east of the other, so that nothing meets: within a column
 *  the walk goes east, or, from room to room, north or south. A longer plan begins like a shorter
 *  one. */
class FloorPlan {
 public:
    static constexpr double kTread_m = 0.3;   //!< of a stair
    static constexpr double kWall_m = 0.25;   //!< from a space to the next
    static constexpr double kHall_m = 21.75;  //!< before the room in which the walk begins

    FloorPlan(std::uint64_t seed, double length_m);
    const std::vector<Space>& spaces() const { return spaces_; }
    Path path() const { return walk_.path(); }
    std::vector<RoadProfile::Ramp> ramps() const;

 private:
    Space enter(SpaceKind kind, Random& random) const;
    void leave(Space& space, Random& random);
    void addCorridor(double length_m, Random& random);
    void addSideRoom(std::size_t corridor, double side, Random& random);
    void addRoom(double lead_m, Random& random);
    void addTurn(Random& random);
    void addPassage(Random& random);
    void addFlight(Random& random);

    Walk walk_;
    double level_m_ = 0;
    Door last_;  //!< through which the walk came
    std::vector<Space> spaces_;
};
}  // namespace delio::synth
