#pragma once
#include <cstdint>

#include "gz_input.h"

namespace delio::io {
/** Reads past what follows the version of a mrpt::img::CImage in a file. Throws
 *  std::runtime_error for a version that MRPT does not read either, and where the file ends. */
void skipImage(GzInput& in, std::uint8_t version);
}  // namespace delio::io
