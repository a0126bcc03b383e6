#pragma once
#include "mesh.h"
#include "random.h"

namespace delio::synth {
// Street furniture. `frame`: the origin is on the ground, in the middle of the object.

/** Along the frame's x axis. */
void addCar(Mesh& mesh, const Frame& frame, Random& random);
constexpr double kCarLength_m = 4.9;  //!< the longest
constexpr double kCarWidth_m = 1.85;  //!< the widest

/** A trunk and a crown of leaves, rough at the distance between the points of a scan. */
void addTree(Mesh& mesh, const Frame& frame, Random& random);
/** Along the frame's x axis. */
void addHedge(Mesh& mesh, const Frame& frame, double length, Random& random);
/** A low wall with a fence of posts. */
void addGardenWall(Mesh& mesh, const Frame& frame, double length, Random& random);
void addLampPost(Mesh& mesh, const Frame& frame, Random& random);
/** A plate on a post that looks along the frame's x axis. */
void addSign(Mesh& mesh, const Frame& frame, Random& random);
void addBin(Mesh& mesh, const Frame& frame, Random& random);
}  // namespace delio::synth
