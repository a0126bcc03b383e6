#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace delio::evaluation {
/** How a list of errors is spread; NaN where the list is empty. */
struct Spread {
    double rmse = 0;    //!< root mean square
    double median = 0;  //!< half of the errors are at most this
    double p95 = 0;     //!< 95 % of the errors are at most this
    double max = 0;     //!< the largest
};

/** Of errors in any order, all finite. */
Spread spreadOf(std::vector<double> errors);

/** Errors of relative motions, and how they are spread. */
struct RelativeError {
    std::vector<double> translations_m;  //!< entry i: of the motion from pose i to pose i + delta
    std::vector<double> rotations_deg;   //!< the same for its rotation
    Spread translation_m;                //!< of `translations_m`
    Spread rotation_deg;                 //!< of `rotations_deg`
};

/** RPE: errors of the relative motions over `delta` poses (1 or more). Same count of poses in
 *  both, of the same moving frame; their fixed frames may differ. */
RelativeError relativeError(const std::vector<Eigen::Isometry3d>& reference,
                            const std::vector<Eigen::Isometry3d>& estimate, std::size_t delta = 1);

/** Between poses of one fixed frame, such as a map's: nothing is aligned. Same count in both. */
struct PoseError {
    Spread translation_m;  //!< distances between the positions
    Spread rotation_deg;   //!< angles between the orientations
};
/** Of each pose of `estimate` beside that of `reference`. */
PoseError poseError(const std::vector<Eigen::Isometry3d>& reference,
                    const std::vector<Eigen::Isometry3d>& estimate);
}  // namespace delio::evaluation
