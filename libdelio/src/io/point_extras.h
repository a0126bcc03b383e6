#pragma once
#include <string>

#include "delio/odometry/scan.h"

namespace delio::io {
/** Takes rings and times of the points from the files STEM.ring (uint16) and STEM.time (float32,
 *  seconds from the stamp), one value a point, where they are there; NaN: the point has no time.
 * Throws Error where a file cannot be read or has not one value for each point, or a time is beyond
 * 1 s. */
void readPointExtras(const std::string& stem, Scan& scan);
}  // namespace delio::io
