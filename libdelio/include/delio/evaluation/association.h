#pragma once
#include <cstddef>
#include <vector>

#include "delio/formats/trajectory.h"

namespace delio::evaluation {
/** Two trajectories pose by pose: `reference[i]` and `estimate[i]` belong together. */
struct Association {
    std::vector<Eigen::Isometry3d> reference;  //!< poses of the reference that have a partner
    std::vector<Eigen::Isometry3d> estimate;   //!< their partners
    std::vector<std::size_t>
        estimateRows;                    //!< estimate[i] is row estimateRows[i] of what was given
    std::vector<double> stamps_s;        //!< of the pairs; empty where neither file has stamps
    std::size_t unmatchedReference = 0;  //!< poses of the reference without a partner
    std::size_t unmatchedEstimate = 0;   //!< the same of the estimate
};

/** Where both have stamps, poses belong together that are each other's nearest in time and at most
 *  `tolerance_s` seconds apart (so the order of time is kept, and no pose is used twice).
 *  Otherwise rows belong together. Stamps have to rise.
 *  Throws Error where rows are to be matched and their counts differ, or where no stamps match. */
Association associate(const io::Trajectory& reference, const io::Trajectory& estimate,
                      double tolerance_s = 0.02);
}  // namespace delio::evaluation
