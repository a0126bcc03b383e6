#pragma once
#include "core/scan_trajectory.h"
#include "odometry/preprocess.h"

namespace delio::odometry {
/** A scan as it came, and the sensor's trajectory during it. */
struct MovingScan {
    PointCloud cloud;
    double time_s = 0;                   //!< of the scan, since the start
    ScanTrajectory trajectory{Twist{}};  //!< sensor to map, times from the scan's
};
}  // namespace delio::odometry
