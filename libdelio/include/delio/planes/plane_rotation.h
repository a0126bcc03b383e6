#pragma once
#include "delio/planes/correspondence.h"
#include "delio/planes/prior.h"

namespace delio::planes {
/** What plane residuals say of the rotation alone. */
struct PlaneRotation {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();  //!< rad; R exp(step) is the better rotation
    /** 1/rad^2, right tangent (sensor's frame): the Schur complement H_rr - H_rt H_tt^-1 H_tr; what
     *  is known of the rotation before is not in it. */
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double weight = 0;  //!< sum of the matches' weights
};

/** The rotation from translation-free residuals: n . (R p + t - q) is linear in t, so with N the
 *  stack of weighted normals the projection I - N (N'N)^-1 N' takes t out of all residuals, and
 *  what is left has a minimum over R alone. One Gauss-Newton step. What is known before (in units
 *  of the weights) is fused by its information; an axis of which nothing is known stays. */
PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 const Prior& prior = {});
}  // namespace delio::planes
