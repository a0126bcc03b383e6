#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
// What grows beside roads, besides the trees and hedges of towns (furniture.h): leaves turned at
// random, rough at the distance between the points of a scan. `frame`: the origin is on the ground,
// in the middle.

/** 0.6-2 m high. */
void addBush(Mesh& mesh, const Frame& frame, Random& random);
/** 7-14 m high, with a round crown. */
void addTallTree(Mesh& mesh, const Frame& frame, Random& random);
/** 6-16 m high, with branches from near the ground. */
void addConifer(Mesh& mesh, const Frame& frame, Random& random);
/** High grass and weeds on `length` x `width`. */
void addGrass(Mesh& mesh, const Frame& frame, double length, double width, Random& random);
}  // namespace delio::synth
