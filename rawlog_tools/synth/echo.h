#pragma once
#include "random.h"
#include "ray_caster.h"

namespace delio::synth {
// Model of the instrument's echoes.

/** How likely an echo is to be noticed. */
double detectionProbability(const Hit& hit);

/** Of an echo, 0 ... 1, in KITTI's steps of 0.01. `gain`: of the laser. */
float intensity(const Hit& hit, double gain, Random& random);

/** The beam has a breadth: at the edge of what is in front, part of it goes on to what is behind
 * it. Where the two echoes are less than a pulse apart they are taken for one in between. `next`:
 * what the ray beside it hit. The share of the range from the one to the other, mostly 0. */
double mixedShare(const Hit& hit, const Hit& next, Random& random);
}  // namespace delio::synth
