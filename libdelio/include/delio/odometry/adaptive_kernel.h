#pragma once
#include <Eigen/Geometry>
#include <deque>

#include "delio/core/geometry.h"

namespace delio {
/** The width of the registration's first kernel, from what the motion model was off lately (Vizzo
 *  et al., KISS-ICP: adaptive threshold). */
class AdaptiveKernel {
 public:
    /** What the pose turned out to be beside its prediction. */
    void observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted);

    /** False while little is known. */
    bool isKnown() const;

    /** Three standard deviations, within these limits; `most` while little is known. Metres. */
    double width(double least, double most) const;

 private:
    std::deque<double> errors_m_;  //!< of the latest predictions
};
}  // namespace delio
