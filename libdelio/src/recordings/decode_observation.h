#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationRotatingScan.h>

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

/** Fills `points` (metres, sensor frame, row by row; a CPointsMapXYZI with intensities 0 to 1 where
 *  the scan has an intensity image) and `rings` (the rows) of `scan` from a range image. Only its
 *  own returns, the strongest, are taken, not those of `rangeOtherLayers`. Images of
 *  CObservationRotatingScan::fromVelodyne() are recognised by their model: they rotate clockwise,
 * and the lasers of a column fire one after the other. Throws Error if rows and images have
 * different sizes, or if the elevation angles are unknown: MRPT does not store them, so those of
 * Velodyne's models with 16 and 32 rows are used. */
void decodeRotatingScan(const mrpt::obs::CObservationRotatingScan& observation, Scan& scan);
}  // namespace delio::io
