#pragma once
#include "delio/points/point_registration.h"

namespace delio::points {
/** Registration where `guess` may be off by `reach` metres. The rings that a sensor draws on the
 *  ground look the same wherever it stands and would confirm any guess; so starts all over a disc
 *  are compared by those points alone that the guess does not explain. The disc is level where
 *  `upright` turns the points' frame such that z is up. */
PointEstimate searchPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& guess, double reach,
                           const Eigen::Matrix3f& upright, const PointRegistrationOptions& options);

/** Registration where the rotation of `guess` may be off by up to 30 deg about any axis: by the
 * hand that carries the sensor, or a bump. Where a share of `enough` fits, no more is tried. */
PointEstimate searchTurns(const PointMap& map, const Eigen::Matrix3Xd& points,
                          const Eigen::Isometry3d& guess, double enough,
                          const PointRegistrationOptions& options);

/** True where the points see that direction (a unit vector of the map's frame): the scan comes back
 *  to `pose` from `probe` metres along it to either side. (Rings of a sensor in a tunnel lie on
 *  those of the scan before wherever it stands: there it stays where it was put.) */
bool pointsSee(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               const Eigen::Vector3d& axis, double probe, const PointRegistrationOptions& options);
}  // namespace delio::points
