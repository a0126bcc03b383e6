#pragma once
#include <Eigen/Core>

#include "delio/rotation/outlier_removal.h"
#include "delio/stage_options.h"

namespace delio::rotation {
/** Section III-D. With `kernel_deg` = 0 each normal is paired with its nearest neighbour on the
 *  sphere, as the paper says; inside a dense blob every normal then finds a partner beside itself,
 *  which pulls towards the start. With a kernel, the densities of the two patterns are correlated
 *  instead: each normal is paired with all normals of the other pattern, weighted by a Gaussian of
 *  the angle between them that narrows from `kernel_deg` to `last_kernel_deg`. */
struct PatternRegistrationOptions : public StageOptions {
    double kernel_deg = 8;
    double last_kernel_deg = 0.7;
    double cell_deg = 0.5;
    unsigned max_iterations = 60;
    double converged_deg = 0.001;
    unsigned min_normals = 50;
    double min_observability = 0.01;
    double max_correction_deg = 30;
    double independent_share = 0.05;
    double view_distance = 2;
    double prior_sigma_deg = 1.0;

 protected:
    std::vector<OptionField> fields() override;
};

struct RotationEstimate {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  //!< n_from = rotation * n_to
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    //!< rad^2, right tangent (frame `to`)
    /** Eigenvalues, rising, of the mean of w (I - n n'): how well the pattern fixes its three axes,
     *  0 to 1. Ground alone gives (0, 1, 1). */
    Eigen::Vector3d observability = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd unobservedAxes;  //!< unit vectors in frame `to` where the prediction was kept
    std::size_t matches = 0;
    double residual_rad = 0;  //!< weighted root mean square angle of the pairs
    unsigned iterations = 0;
    /** False: too few normals, or a rotation too far from the prediction; it is the prediction. */
    bool valid = false;
    bool tooFar = false;
};

/** The rotation that turns the pattern of scan `to` onto that of scan `from`, by nearest neighbours
 *  or kernel-weighted pairs and SVD, iterated to convergence from the prediction. */
RotationEstimate registerPatterns(const Pattern& from, const Pattern& to,
                                  const Eigen::Matrix3d& predicted,
                                  const PatternRegistrationOptions& options);
}  // namespace delio::rotation
