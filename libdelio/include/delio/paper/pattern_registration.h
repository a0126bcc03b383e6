#pragma once
#include <Eigen/Core>

#include "delio/core/estimates.h"
#include "delio/core/stage_options.h"
#include "delio/paper/outlier_removal.h"

namespace delio::paper {
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

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** The rotation that turns the pattern of scan `to` onto that of scan `from`, by nearest neighbours
 *  or kernel-weighted pairs and SVD, iterated to convergence from the prediction. */
RotationEstimate registerPatterns(const Pattern& from, const Pattern& to,
                                  const Eigen::Matrix3d& predicted,
                                  const PatternRegistrationOptions& options);
}  // namespace delio::paper
