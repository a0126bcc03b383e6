#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
/** A house with a front of windows, doors and balconies. `frame`: the origin is the left end of the
 *  front at ground level, x runs along the front, y away from the street; it has two floors or
 * more. */
void addBuilding(Mesh& mesh, const Frame& frame, double width, double depth, Random& random,
                 int mostFloors = 5);

/** A plain block, for buildings far behind the street. */
void addBlock(Mesh& mesh, const Frame& frame, double width, double depth, Random& random);
}  // namespace delio::synth
