#pragma once
#include <Eigen/Core>

#include "core/estimates.h"
#include "delio/core/odometry_options.h"
#include "paper/outlier_removal.h"

namespace delio::paper {
/** Multiplies the weights of the normals near the spin axis, which are those of ground and roofs,
 * by `ground_weight`. `up`: unit vector, the spin axis in the sensor's frame. */
void weighGround(Pattern& pattern, const Eigen::Vector3f& up,
                 const PatternRegistrationOptions& options);

/** The rotation that turns the pattern of scan `to` onto that of scan `from`, by nearest neighbours
 *  or kernel-weighted pairs and SVD, iterated to convergence from the prediction. */
RotationEstimate registerPatterns(const Pattern& from, const Pattern& to,
                                  const Eigen::Matrix3d& predicted,
                                  const PatternRegistrationOptions& options);
}  // namespace delio::paper
