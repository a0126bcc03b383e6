#pragma once
#include <Eigen/Geometry>

#include "core/estimates.h"
#include "delio/core/odometry_options.h"
#include "paper/outlier_removal.h"

namespace delio::paper {
/** The rotation `found`, turned on until the normals at the same places agree; axes that the
 *  pattern leaves open are not touched. `translation` belongs to it: p_from = R p_to + t. As
 *  `found` where there are too few pairs, as with patterns of modes, which have no place. The
 *  covariance stays that of the pattern. */
RotationEstimate registerInPlace(const Pattern& from, const Pattern& to,
                                 const RotationEstimate& found, const Eigen::Vector3d& translation,
                                 const RotationInPlaceOptions& options);
}  // namespace delio::paper
