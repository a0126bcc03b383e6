#pragma once
#include "delio/odometry/plane_odometry_options.h"
#include "delio/scan/scan.h"

namespace delio {
/** The size of the place that a scan shows, 1 for streets and less for rooms: nine points in ten
 *  are within 16 m times this. Not below 0.25. */
double scaleOf(const Scan& scan);

/** The options with all lengths that depend on the place, which are given for streets, times
 *  `scale`. */
PlaneOdometryOptions atScale(PlaneOdometryOptions options, double scale);
}  // namespace delio
