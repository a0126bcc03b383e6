#pragma once
#include "floor_plan.h"
#include "mesh.h"
#include "random.h"

namespace delio::synth {
/** Floor, steps, ceiling, walls with the openings of the doors, and the reveals of those that the
 *  space owns. */
void addShell(Mesh& mesh, const Space& space, Random& random);

/** In the middle between two ends of a wall, at its foot: x along the wall, y into the space. */
Frame wallFrame(const Space& space, Wall wall, double along_m);
/** Of a wall, on its own axis. */
struct WallEnds {
    double from_m, to_m;
};
WallEnds endsOf(const Space& space, Wall wall);
}  // namespace delio::synth
