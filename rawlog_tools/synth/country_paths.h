#pragma once
#include <cstdint>

#include "path.h"

namespace delio::synth {
// Paths of at least `length_m` that never come back, with a margin before and behind.

/** Bends of 60-300 m radius, a few tight ones. */
Path ruralPath(std::uint64_t seed, double length_m);
/** Wide curves of 700-2000 m radius. */
Path highwayPath(std::uint64_t seed, double length_m);
/** Bends of 8-22 m radius, one after the other, between trees. */
Path forestPath(std::uint64_t seed, double length_m);
Path straightPath(double length_m);
}  // namespace delio::synth
