#pragma once
#include <Eigen/Core>

#include "core/estimates.h"
#include "delio/core/odometry_options.h"
#include "paper/outlier_removal.h"

namespace delio::paper {
/** The rotation that turns the pattern of scan `to` onto that of scan `from`, by nearest neighbours
 *  or kernel-weighted pairs and SVD, iterated to convergence from the prediction. */
RotationEstimate registerPatterns(const Pattern& from, const Pattern& to,
                                  const Eigen::Matrix3d& predicted,
                                  const PatternRegistrationOptions& options);
}  // namespace delio::paper
