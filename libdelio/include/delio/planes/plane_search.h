#pragma once
#include "delio/planes/plane_registration.h"
#include "delio/surfaces/normals.h"

namespace delio::planes {
/** Overlap of a scan's surfaces with the map's at `pose` (sensor to map), 0 to 1: a surface counts
 *  where it meets a plane that looks the same way, within about `kernel` (metres). All directions
 *  count the same in all, so that the ground, which fits nearly anywhere, does not decide. */
double agreement(const PlaneMap& map, const surfaces::SurfaceNormals& surfaces,
                 const Eigen::Isometry3d& pose, double kernel);

/** Global search: where a scan of known rotation lies best within `radius` (metres, horizontally)
 *  of `centre` (sensor to map): the agreement of starts all over that disc is compared, and the
 *  best are registered. For a prediction that is off by metres. `surfaces`: of the same scan. */
PlaneEstimate searchInPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                             const surfaces::SurfaceNormals& surfaces,
                             const Eigen::Isometry3d& centre, double radius,
                             const PlaneRegistrationOptions& options);
}  // namespace delio::planes
