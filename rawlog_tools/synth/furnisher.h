#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "floor_plan.h"
#include "mesh.h"
#include "random.h"
#include "road.h"

namespace delio::synth {
/** Puts things into a space: along the walls, then in the middle, where neither the walk nor a door
 *  nor another thing is in the way. */
class Furnisher {
 public:
    /** From the middle of the walk to whatever stands beside it. */
    static constexpr double kClear_m = 0.6;

    Furnisher(Mesh& mesh, const Space& space, const Road& road, Random random)
        : mesh_(mesh), space_(space), road_(road), random_(random) {}
    void furnish();

 private:
    void lineWall(Wall wall);
    void fillMiddle();
    void addPillars();
    void hangLamps();
    /** Takes the place of that size about the frame's origin if it is free. */
    bool take(const Frame& frame, double length, double width);
    bool isInTheWay(const Eigen::AlignedBox2d& box) const;
    bool isAtDoor(const Eigen::AlignedBox2d& box) const;

    Mesh& mesh_;
    const Space& space_;
    const Road& road_;
    Random random_;
    std::vector<Eigen::AlignedBox2d> taken_;
};
}  // namespace delio::synth
