#pragma once
#include <optional>

#include "delio/odometry/scan.h"

namespace delio::io {
/** Whether the recorder took the sensor's motion out of a scan's points. Where a turning sensor
 *  gives each point's time, the azimuths of a ring rise with time to a fraction of a degree, but
 *  those of points that were moved do not. A sensor that stands still looks as if
 *  they were not, which does no harm. Nothing: there are no times, too few points, nothing
 *  turns, or no motion explains the azimuths. */
std::optional<bool> isMotionCompensated(const Scan& scan);

/** False where the times of a scan's points do not fit their directions: points that follow each
 *  other and lie in one direction were measured at times far apart. Such times describe no sweep of
 *  a sensor. True also where there are too few points. */
bool timesFitDirections(const Scan& scan);
}  // namespace delio::io
