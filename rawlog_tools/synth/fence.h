#pragma once
#include <Eigen/Core>
#include <vector>

#include "mesh.h"
#include "random.h"

namespace delio::synth {
// What runs along a road. `feet`: places on the ground, one behind the other; there stand the
// posts.
using Feet = std::vector<Eigen::Vector3d>;

/** Wooden posts with two or three rails. */
void addFieldFence(Mesh& mesh, const Feet& feet, Random& random);
/** A low wall of rough stones. */
void addStoneWall(Mesh& mesh, const Feet& feet, Random& random);
/** A steel beam of W section on posts; its front looks to the left of the feet's direction, or, if
 *  `right`, to the right. */
void addGuardRail(Mesh& mesh, const Feet& feet, bool right);
/** Panels between steel posts that stand out a little. */
void addNoiseWall(Mesh& mesh, const Feet& feet, double height);
}  // namespace delio::synth
