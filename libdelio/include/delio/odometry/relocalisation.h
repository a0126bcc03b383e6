#pragma once
#include "delio/paper/pattern_registration.h"
#include "delio/planes/plane_search.h"

namespace delio {
/** Finds a scan again in the map of planes where the prediction is off by metres: rotation first,
 * by the paper's way, which no translation can disturb (the pattern of this scan's normals on that
 * of a `reference` scan), then a global search of the place within `radius` metres.
 *  @param reference surfaces of a scan whose pose in the map is `referencePose` (sensor to map)
 *  @param points, surfaces of the scan that is sought, in its sensor's frame
 *  @param guess sensor to map */
planes::PlaneEstimate relocalise(const planes::PlaneMap& map,
                                 const surfaces::SurfaceNormals& reference,
                                 const Eigen::Isometry3d& referencePose,
                                 const Eigen::Matrix3Xd& points,
                                 const surfaces::SurfaceNormals& surfaces,
                                 const Eigen::Isometry3d& guess, double radius,
                                 const planes::PlaneRegistrationOptions& options,
                                 const paper::PatternRegistrationOptions& pattern);
}  // namespace delio
