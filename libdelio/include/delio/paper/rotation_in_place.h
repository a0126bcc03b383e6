#pragma once
#include <Eigen/Geometry>

#include "delio/core/estimates.h"
#include "delio/core/stage_options.h"
#include "delio/paper/outlier_removal.h"

namespace delio::paper {
/** Section III-D pairs normals by their direction alone. What a scan sees of the ground moves along
 *  with the vehicle, and with few rings so do the bushes' normals: their pattern stands still while
 *  the vehicle turns. Once a translation is known too, each normal is paired with those of the
 *  other scan that were found at its place; they are of one surface. */
struct RotationInPlaceOptions : public StageOptions {
    unsigned rounds = 1;
    double place_sigma = 0.5;
    double kernel_deg = 3;
    double last_kernel_deg = 0.7;
    unsigned min_pairs = 500;
    unsigned max_iterations = 30;
    double converged_deg = 0.001;

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** The rotation `found`, turned on until the normals at the same places agree; axes that the
 *  pattern leaves open are not touched. `translation` belongs to it: p_from = R p_to + t. As
 *  `found` where there are too few pairs, as with patterns of modes, which have no place. The
 *  covariance stays that of the pattern. */
RotationEstimate registerInPlace(const Pattern& from, const Pattern& to,
                                 const RotationEstimate& found, const Eigen::Vector3d& translation,
                                 const RotationInPlaceOptions& options);
}  // namespace delio::paper
