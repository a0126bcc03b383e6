#pragma once
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>
#include <vector>

namespace delio::scan {
/** A motion at constant speed: the twist that leads over `duration_s` (more than 0) from the
 *  identity to `increment`, per second. */
struct Motion {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< m/s, in the sensor's frame
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();   //!< rad/s, a rotation vector, likewise

    static Motion of(const mrpt::poses::CPose3D& increment, double duration_s);
};

/** When each point of a turning LiDAR was measured, told by its azimuth: seconds from the moment at
 *  which the sensor looked ahead (x), where the stamp of KITTI's raw scans is. A sweep of `sweep_s`
 *  begins at the back and runs clockwise seen from above, as Velodyne's do. */
std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s);

/** The points (metres, sensor's frame at each point's own time) as the sensor would have seen them
 *  all at once at its stamp. `times_s`: of each point, seconds from the stamp. */
Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const Motion& motion);
}  // namespace delio::scan
