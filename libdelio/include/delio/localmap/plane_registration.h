#pragma once
#include <Eigen/Core>

#include "delio/localmap/plane_map.h"
#include "delio/localmap/plane_match.h"
#include "delio/rotation/normals.h"
#include "delio/rotation/pattern_registration.h"
#include "delio/stage_options.h"
#include "delio/translation/line_registration.h"

namespace delio::localmap {
struct PlaneRegistrationOptions : public StageOptions {
    double first_kernel = 1.0;
    double last_kernel = 0.1;
    double point_sigma = 0.01;
    unsigned max_iterations = 60;
    double converged_rad = 2e-5;
    double converged_m = 5e-4;
    unsigned min_matches = 100;
    double min_rotation_share = 1e-3;
    double min_translation_share = 2e-3;
    double independent_share = 0.16;
    double prior_sigma = 0.5;
    double prior_sigma_deg = 1.0;
    double search_speed = 40;
    double search_radius = 30;
    double search_step = 1;

 protected:
    std::vector<OptionField> fields() override;
};

/** A scan in the map. Of both estimates the frame `from` is the map's and `to` the sensor's. */
struct PlaneEstimate {
    rotation::RotationEstimate rotation;
    translation::TranslationEstimate translation;
    double share = 0;  //!< of the points in voxels with a plane that lie on it, 0 to 1
    bool valid = false;
};

/** The prediction, where there is nothing to register: not valid, with the motion model's
 * variances.
 */
PlaneEstimate predictedEstimate(const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                const PlaneRegistrationOptions& options);

/** Points next to a plane of the map at pose (R, t), with robust weights (Geman-McClure of width
 *  `kernel`, metres) over the variance of plane and point. In the order of the points. */
PlaneMatches matchPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                         const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel,
                         double point_sigma);

/** Rotation from translation-free residuals, then translation alone, with new matches each time,
 *  while the kernel narrows from `kernel` (metres) to last_kernel: from the predicted pose (sensor
 *  to map) to convergence. An axis that the planes do not see keeps the prediction. */
PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel,
                               const PlaneRegistrationOptions& options);

/** How well a scan's surfaces lie on the map's at a pose, 0 to 1: a surface counts where it meets a
 *  plane that looks the same way, within about `kernel` (metres). All directions count the same
 *  in all, so that the ground, which fits nearly anywhere, does not decide. */
double agreement(const PlaneMap& map, const rotation::SurfaceNormals& surfaces,
                 const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double kernel);

/** Where a scan of known rotation lies best within `radius` (metres, horizontally) of `centre`:
 *  the agreement of starts all over that disc is compared, and the best are registered. For a
 *  prediction that is off by metres. `surfaces`: of the same scan. */
PlaneEstimate searchInPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                             const rotation::SurfaceNormals& surfaces, const Eigen::Matrix3d& R,
                             const Eigen::Vector3d& centre, double radius,
                             const PlaneRegistrationOptions& options);
}  // namespace delio::localmap
