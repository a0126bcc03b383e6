#pragma once
#include "delio/increment.h"
#include "delio/rotation/pattern_registration.h"
#include "delio/translation/line_registration.h"

namespace delio {
/** What both stages found, with the covariance in the right tangent, which is the later frame's:
 * the translation has its own noise, and through the lever also that of the rotation it was
 * unrotated by. */
Increment incrementOf(const rotation::RotationEstimate& rotation,
                      const translation::TranslationEstimate& translation);
}  // namespace delio
