#pragma once
#include <Eigen/Geometry>
#include "delio/core/odometry_options.h"

#include "paper/line_registration.h"

namespace delio::paper {
/** Rotation and translation found together. */
struct CoupledEstimate {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< p_from = pose * p_to
    std::size_t matches = 0;                                 //!< pairs of lines
    unsigned iterations = 0;                                 //!< until it stood still
    bool valid = false;  //!< false: too few matches; pose is the prediction
};

/** Rotation and translation together from the same line clouds, as Velas et al. do it (Collar Line
 *  Segments, 2016): nearest midpoints, pairs farther apart than the mean dropped, SVD over the
 *  closest points of the paired lines, iterated from the prediction. For comparison only: the
 *  paper's claim is that the decoupled way is better. `to` is not unrotated. */
CoupledEstimate registerCoupled(const LineCloud& from, const LineCloud& to,
                                const Eigen::Isometry3d& predicted,
                                const LineRegistrationOptions& options);
}  // namespace delio::paper
