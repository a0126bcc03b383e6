#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace delio::evaluation {
/** How a list of errors is spread; NaN where the list is empty. */
struct Spread {
    double rmse = 0;
    double median = 0;
    double p95 = 0;  //!< 95 % of the errors are at most this
    double max = 0;
};

Spread spreadOf(std::vector<double> errors);

struct RelativeError {
    std::vector<double> translations_m;  //!< entry i: of the motion from pose i to pose i + delta
    std::vector<double> rotations_deg;   //!< the same for its rotation
    Spread translation_m;
    Spread rotation_deg;
};

/** RPE: errors of the relative motions over `delta` poses (1 or more). Same count of poses in
 *  both, of the same moving frame; their fixed frames may differ. */
RelativeError relativeError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate, std::size_t delta = 1);

/** Between poses of one fixed frame, such as a map's: nothing is aligned. Same count in both. */
struct PoseError {
    Spread translation_m;
    Spread rotation_deg;
};
PoseError poseError(const std::vector<Eigen::Isometry3d>& reference,
                    const std::vector<Eigen::Isometry3d>& estimate);
}  // namespace delio::evaluation
