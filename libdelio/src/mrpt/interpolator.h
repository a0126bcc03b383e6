#pragma once
#include <string>

#include "delio/formats/trajectory.h"

namespace delio::io {
/** Writes poses with stamps as text of MRPT's CPose3DInterpolator: Unix time, x y z (m), yaw pitch
 *  roll (rad), six decimals. `epoch_s`: Unix time of second 0 of the stamps. Throws Error where
 * that fails. */
void writeInterpolator(const Trajectory& trajectory, double epoch_s, const std::string& path);
}  // namespace delio::io
