#pragma once
#include <mrpt/obs/CObservationRotatingScan.h>

#include "delio/odometry/scan.h"

namespace delio::io {
/** Fills `points` (metres, sensor frame, row by row; a CPointsMapXYZI with intensities 0 to 1 where
 *  the scan has an intensity image) and `rings` (the rows) of `scan` from a range image. Only its
 *  own returns, the strongest, are taken, not those of `rangeOtherLayers`. Images that
 *  CObservationRotatingScan::fromVelodyne() made are told by the model that it writes: theirs turn
 *  clockwise, and the lasers of a column lag behind one another.
 *  Throws Error where rows and images disagree in size, or the elevation angles are not known: MRPT
 *  keeps none with the scan, and those of Velodyne's models of 16 and 32 rows are taken. */
void decodeRotatingScan(const mrpt::obs::CObservationRotatingScan& observation, Scan& scan);
}  // namespace delio::io
