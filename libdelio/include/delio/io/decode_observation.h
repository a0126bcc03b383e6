#pragma once
#include <mrpt/obs/CObservation.h>

#include "delio/odometry/scan.h"

namespace delio::io {
/** True for the observation classes that decodeObservation() understands: CObservationPointCloud,
 *  CObservationVelodyneScan, CObservationRotatingScan, CObservation3DRangeScan. */
bool isScan(const mrpt::obs::CObservation& observation);

/** Fills `points`, `rings` and `sensorPose` of a scan; points are in the sensor's frame. Clouds
 *  must be in memory already (not externally stored). An observation without points gives an
 *  empty cloud. Throws Error for one that cannot be decoded: Velodyne packets without their
 *  calibration or of an unknown count of lasers, a rotating scan whose images disagree in size or
 *  whose elevation angles are unknown, a sensor pose that is not finite. */
Scan decodeObservation(const mrpt::obs::CObservation& observation);
}  // namespace delio::io
