#pragma once
#include <Eigen/Geometry>

#include "delio/core/estimates.h"
#include "delio/core/stage_options.h"
#include "delio/planes/plane_map.h"
#include "delio/planes/prior.h"

namespace delio::planes {
/** How a scan is registered to planes. */
struct PlaneRegistrationOptions : public StageOptions {
    double last_kernel = 0.1;
    double point_sigma = 0.01;
    unsigned max_iterations = 60;
    double converged_rad = 2e-5;
    double converged_m = 5e-4;
    unsigned min_matches = 100;
    double independent_share = 0.16;
    double prior_sigma = 0.5;
    double prior_sigma_deg = 1.0;
    double search_speed = 40;
    double search_radius = 30;
    double search_step = 1;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A scan registered to the map. Of both estimates the frame `from` is the map's and `to` the
 *  sensor's. */
struct PlaneEstimate {
    RotationEstimate rotation;        //!< sensor to map
    TranslationEstimate translation;  //!< in the map's axes
    /** Inlier ratio: of the points in voxels with a plane those that lie on it, 0 to 1. */
    double share = 0;
    bool valid = false;  //!< false: too few correspondences; it is the prediction

    /** Sensor to map. */
    Eigen::Isometry3d pose() const { return isometry(rotation.rotation, translation.translation); }
};

/** The prediction (sensor to map), where there is nothing to register: not valid, with the motion
 *  model's standard deviations, times `growth`. */
PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose,
                                const PlaneRegistrationOptions& options, double growth = 1);

/** What the motion model knows: the prediction (sensor to map), off by prior_sigma. */
Prior priorOf(const Eigen::Isometry3d& predicted, const PlaneRegistrationOptions& options);

/** Rotation from translation-free residuals, then translation alone, with new correspondences each
 *  time, while the kernel narrows from `kernel` (metres) to last_kernel: from the prior's pose to
 *  convergence. Planes and prior are fused by their information. An axis is unobserved where the
 *  planes, which have to find the rotation, too, tell no more than the prior, what errors of the
 *  normals alone would give taken away. */
PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, double kernel,
                               const PlaneRegistrationOptions& options);
}  // namespace delio::planes
