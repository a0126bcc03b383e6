#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "odometry/dynamic_objects.h"

namespace delio::map {
/** Labels the points of moving objects, scan by scan in one direction of time. Backward, a vehicle
 *  that follows drives ahead, and only what drives ahead shows that it moves
 *  (odometry::DynamicObjects). */
class MotionLabels {
 public:
    /** 1 for each of `points` (metres, sensor's frame) that belongs to a moving object, otherwise
     *  0. `time_s` rises from call to call; backward in time it is negative. A scan whose time does
     *  not rise gets no labels: without a time between two scans, nothing moves. The world's z axis
     *  points up. */
    std::vector<std::uint8_t> of(const Eigen::Matrix3Xf& points,
                                 const Eigen::Isometry3d& sensorInWorld, double time_s);

 private:
    odometry::DynamicObjects objects_{DynamicObjectsOptions()};
    double latest_s_ = -std::numeric_limits<double>::infinity();
};
}  // namespace delio::map
