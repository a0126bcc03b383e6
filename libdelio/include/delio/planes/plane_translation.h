#pragma once
#include "delio/planes/correspondence.h"
#include "delio/planes/prior.h"

namespace delio::planes {
/** What plane residuals say of the translation, the rotation known. */
struct PlaneTranslation {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();         //!< m, the map's frame
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  //!< 1/m^2, the map's frame: H_tt
    /** What of it the normals' own errors alone would give. */
    Eigen::Matrix3d pretended = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();  //!< H_tr, 1/(m rad): t against w
    double weight = 0;                                //!< sum of the matches' weights
};

/** The closed form: the least-squares translation of the unrotated scan. What is known before (in
 *  units of the weights) is fused by its information; along an axis of which nothing is known there
 *  is no step. */
PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, const Prior& prior = {});

/** Its step alone: all that is asked for until the last one. */
Eigen::Vector3d stepFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                               const Prior& prior = {});
}  // namespace delio::planes
