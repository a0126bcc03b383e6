#pragma once
#include <Eigen/Geometry>

#include <vector>

namespace delio::evaluation {
/** Distances between positions after alignment, metres; NaN where there are no poses. */
struct AbsoluteError {
    double rmse_m = 0;  //!< root mean square
    double max_m = 0;   //!< largest
};

/** APE: the positions of the estimate are moved onto those of the reference by the best rigid
 *  motion (Umeyama, no scale), whatever their fixed frames are. Same count of poses in both. */
AbsoluteError absoluteError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate);
}  // namespace delio::evaluation
