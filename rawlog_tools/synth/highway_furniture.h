#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
// Objects above and beside a highway. `frame`: the origin is on the ground, x along the road, y
// across it.

/** From `-half` to `half` across, on three rows of columns. */
void addBridge(Mesh& mesh, const Frame& frame, double half, Random& random);
/** Over one carriageway, from `near` to `far` across, with plates that look against x. */
void addGantry(Mesh& mesh, const Frame& frame, double near, double far, Random& random);
/** A large plate on two posts. */
void addDirectionSign(Mesh& mesh, const Frame& frame, Random& random);
/** A metre high, with a reflector. */
void addDelineator(Mesh& mesh, const Frame& frame);
/** Of a power line or a telephone line. */
void addPole(Mesh& mesh, const Frame& frame, Random& random);
}  // namespace delio::synth
