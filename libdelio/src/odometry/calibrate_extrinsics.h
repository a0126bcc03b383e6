#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/scan_trajectory.h"
#include "odometry/plane_map.h"
#include "odometry/register_planes.h"

namespace delio::odometry {
/** What two sensors saw about one moment of a drive. */
struct CalibrationView {
    PlaneMap map;                  //!< of the first sensor's scans, in its frame at the moment
    PoseTable trajectory;          //!< first sensor's frame to that at the moment; times from then
    Eigen::Matrix3Xf points = {};  //!< of the other sensor, in its frame at each point's time
    std::vector<float> times_s = {};  //!< of these points, from the moment
};

/** Pose of a sensor in the frame of another one. */
struct CalibratedPose {
    PlaneEstimate estimate;  //!< of the other sensor's points against the first one's maps
    /** Order [x y z wx wy wz], metres and radians, about the axes of the first sensor: from the
     *  scatter of the views, and the noise of planes and points. */
    Matrix6 covariance = Matrix6::Zero();
};

/** Registers the points of the other sensor, of all views together, to the first one's planes:
 *  rotation from translation-free residuals, then translation. `given`: the pose to start from,
 *  which stays along and about axes that no view shows. The estimate is not valid where the views
 *  have too few points on planes. */
CalibratedPose calibrateExtrinsics(const std::vector<CalibrationView>& views,
                                   const Eigen::Isometry3d& given,
                                   const PlaneRegistrationOptions& options);
}  // namespace delio::odometry
