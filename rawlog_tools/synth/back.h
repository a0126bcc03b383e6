#pragma once
#include <memory>

#include "motion.h"

namespace delio::synth {
/** `motion` from `end_s` back to its beginning, looking where it goes, `aside_m` to the left of
 *  where it went before: in the lane of those who come the other way. */
std::shared_ptr<const Motion> drivenBack(std::shared_ptr<const Motion> motion, double end_s,
                                         double aside_m);
}  // namespace delio::synth
