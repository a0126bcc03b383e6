#pragma once
#include <Eigen/Geometry>

#include <string>

namespace delio {
/** The pose that --initial-pose says: X,Y,Z,YAW_DEG, metres and degrees. Error for anything else.
 */
Eigen::Isometry3d initialPoseIn(const std::string& text);

/** Position of the GNSS antenna in the vehicle's frame, metres. Throws Error for another text than
 *  X,Y,Z. */
Eigen::Vector3d antennaIn(const std::string& text);
}  // namespace delio
