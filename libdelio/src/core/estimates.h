#pragma once
#include <Eigen/Core>
#include <cstddef>

#include "delio/core/increment.h"

namespace delio {
/** Estimated rotation of scan `to` against a reference `from` (a scan or a map). Rotation and
 *  translation are separate problems with three unknowns each. */
struct RotationEstimate {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  //!< n_from = rotation * n_to
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    //!< rad^2, right tangent (frame `to`)
    /** Eigenvalues, rising, of the mean of w (I - n n'): how well the pattern fixes its three axes,
     *  0 to 1. Ground alone gives (0, 1, 1). */
    Eigen::Vector3d observability = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd unobservedAxes;  //!< unit vectors in frame `to` where the prediction was kept
    std::size_t matches = 0;          //!< number of pairs of normals, or of points on planes
    double residual_rad = 0;          //!< weighted root mean square angle of the pairs
    unsigned iterations = 0;          //!< in all rounds
    bool converged = false;           //!< false: ended by the most iterations that are allowed
    /** False: too few normals, or a rotation too far from the prediction; it is the prediction. */
    bool valid = false;
    bool tooFar = false;  //!< it was found, but farther from the prediction than is allowed
};

/** The same of the translation of the unrotated scan. */
struct TranslationEstimate {
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  //!< p_from = p_to(unrotated) + t
    /** m^2, in the axes of scan `from`; of the lines' own noise, the rotation taken as true. */
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    /** How the translation follows an error of the rotation that the scan was unrotated by:
     *  d translation / d w, w a small rotation (rad) about the axes of scan `from`. */
    Eigen::Matrix3d lever = Eigen::Matrix3d::Zero();
    /** Eigenvalues, rising, of the mean projection of the pairs: how well the lines fix the three
     *  directions, 0 to 1. */
    Eigen::Vector3d observability = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd unobservedAxes;  //!< unit vectors along which the prediction was kept
    std::size_t matches = 0;          //!< number of pairs of lines, or of points on planes
    /** Share of the lines of `to` that have one of `from` next to them (midpoints no farther apart
     *  than `overlap_distance`): how much both scans see of the same surfaces, 0 to 1. */
    double overlap = 0;
    double residual_m = 0;    //!< root mean square distance of the matched lines
    unsigned iterations = 0;  //!< in all rounds
    bool converged = false;   //!< false: ended by the most iterations that are allowed
    bool valid = false;       //!< false: too few lines or matches; translation is the prediction
};

/** Both estimates as one relative pose. Its covariance is in the right tangent, which is the later
 *  frame's: the translation has its own noise, and through the lever also that of the rotation it
 *  was unrotated by. */
Increment incrementOf(const RotationEstimate& rotation, const TranslationEstimate& translation);
}  // namespace delio
