#pragma once
#include "mesh.h"
#include "road.h"

namespace delio::synth {
/** The road between `begin_s` and `end_s` with kerbs, sidewalks and lane marks, and the land to 60
 * m beside it. */
void addGround(Mesh& mesh, const Road& road, double begin_s, double end_s);
}  // namespace delio::synth
