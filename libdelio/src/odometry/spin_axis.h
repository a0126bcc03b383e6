#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace delio::odometry {
/** The axis, a unit vector, that a spinning LiDAR turns about, in the frame of its points (the
 *  sensor at the origin): a cloud may have been turned into the axes of a vehicle. A beam keeps its
 *  elevation, so that neighbouring rays, which are mostly one beam's, differ across the axis only.
 *  Nothing where the points do not look like that. */
std::optional<Eigen::Vector3d> spinAxisOf(const Eigen::Matrix3Xf& points);

/** How long a spinning LiDAR takes for a turn, seconds, from the azimuths and times of its points;
 *  nothing where azimuths do not rise or fall evenly with time. `times_s`: of each point, seconds.
 */
std::optional<double> turnPeriodOf(const Eigen::Matrix3Xf& points,
                                   const std::vector<float>& times_s);

/** The rotation that turns `up`, a unit vector, into z; the identity where it is z already, or
 *  nearly: beams of an HDL-64E do not come from one point. */
Eigen::Matrix3f turnedUp(const Eigen::Vector3d& up);

/** Turns the points' frame such that the sensor spins about z, with most of the points below it
 *  where the frame's own z does not say what is up. */
std::optional<Eigen::Matrix3f> uprightOf(const Eigen::Matrix3Xf& points);

/** The same by the sensor's pose on the vehicle where the source knows that it is tilted, else
 * about the axis that it spins about; the identity where neither says anything. */
Eigen::Matrix3f uprightOf(const Eigen::Isometry3d& sensorPose, const Eigen::Matrix3Xf& points);

/** The unit vector that points up, in the vehicle's frame. */
Eigen::Vector3d upIn(const Eigen::Isometry3d& sensorPose, const Eigen::Matrix3Xf& points);
}  // namespace delio::odometry
