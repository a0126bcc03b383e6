#pragma once
#include <mrpt/obs/CObservationIMU.h>

#include "delio/odometry/imu.h"

namespace delio::io {
/** The sample of an observation, at `stamp_s`. */
ImuSample sampleOf(const mrpt::obs::CObservationIMU& observation, double stamp_s);

/** The inverse, without its time. */
mrpt::obs::CObservationIMU observationOf(const ImuSample& sample);
}  // namespace delio::io
