#pragma once
#include "mesh.h"
#include "road.h"

namespace delio::synth {
/** The road between `begin_s` and `end_s` as its profile has it, and the land beside it: as far as
 *  no other stretch of road is nearer, so that the ground is nowhere built twice. */
void addGround(Mesh& mesh, const Road& road, double begin_s, double end_s);
}  // namespace delio::synth
