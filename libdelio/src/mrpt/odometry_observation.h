#pragma once
#include <mrpt/obs/CObservation.h>

#include <optional>

#include "delio/odometry/wheels.h"

namespace delio::io {
/** The sample of a CObservationOdometry or CObservationRobotPose, at `stamp_s`; nothing of another
 *  observation. */
std::optional<OdometrySample> odometryOf(const mrpt::obs::CObservation& observation,
                                         double stamp_s);

/** The inverse, without its time: a CObservationOdometry where the pose is one in the plane and
 *  its frame the vehicle's, otherwise a CObservationRobotPose. */
mrpt::obs::CObservation::Ptr observationOf(const OdometrySample& sample);
}  // namespace delio::io
