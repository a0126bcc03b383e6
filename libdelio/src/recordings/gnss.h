#pragma once
#include <mrpt/obs/CObservationGPS.h>

#include <functional>
#include <optional>
#include <string>

#include "delio/earth/fix.h"
#include "message_source.h"

namespace delio::io {
/** The fix (GGA) of an observation, its antenna at the sensor's pose; stamps count from `epoch_s`
 *  (Unix time). Nothing where it has no fix. */
std::optional<earth::Fix> fixOf(const mrpt::obs::CObservationGPS& observation, double epoch_s);

/** The fix of a sensor_msgs/NavSatFix, at its Unix time. Nothing where it has no fix. Throws Error
 *  for a message that is cut off. */
std::optional<earth::Fix> fixOf(const Message& navSatFix);

/** True for sensor_msgs/NavSatFix of ROS 1 and 2. */
bool isFixType(const std::string& type);

/** The fixes of the topic with NavSatFix in a bag, the first by name where there are several; none
 *  after what is damaged. `poseOf`: of the frame with a name in the LiDAR's, where it is known; the
 *  antenna is there. */
earth::Fixes fixesOfBag(
    const OpenSource& open,
    const std::function<std::optional<Eigen::Isometry3d>(const std::string&)>& poseOf);
}  // namespace delio::io
