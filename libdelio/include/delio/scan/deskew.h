#pragma once
#include <Eigen/Core>
#include <vector>

#include "delio/core/course.h"

namespace delio::scan {
/** When each point of a turning LiDAR was measured, told by its azimuth: seconds from the moment at
 *  which the sensor looked ahead (x), where the stamp of KITTI's raw scans is. A sweep of `sweep_s`
 *  begins at the back and runs clockwise seen from above, as Velodyne's do. */
std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s);

/** The points (metres, sensor's frame at each point's own time) as the sensor would have seen them
 *  all at once at its stamp. `times_s`: of each point, seconds from the stamp; of the course, too,
 *  which maps the sensor's frame to what it is at the stamp. */
Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const Course& course);
}  // namespace delio::scan
