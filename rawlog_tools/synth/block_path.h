#pragma once
#include <cstdint>

#include "path.h"

namespace delio::synth {
/** Round two blocks that share a street, the first street of the drive. One round of about 900 m:
 *  round the left block and through the shared street again in the same direction, then round both
 *  blocks and through it in the opposite one, and round both once more. `side_m`: of the
 *  vehicle from the centre line of the streets, which repeat exactly. As many rounds as `length_m`
 *  asks for, at least one: the streets do not depend on it. */
Path blockPath(std::uint64_t seed, double length_m, double side_m);
}  // namespace delio::synth
