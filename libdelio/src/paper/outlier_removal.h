#pragma once
#include <Eigen/Eigenvalues>

#include "delio/core/odometry_options.h"
#include "paper/normals.h"

namespace delio::paper {
/** The pattern that normals draw on the unit sphere. */
struct Pattern {
    Eigen::Matrix3Xf directions;   //!< unit vectors
    Eigen::VectorXf weights;       //!< one per direction, from the planarity
    std::size_t normals = 0;       //!< that the directions stand for
    std::size_t removed = 0;       //!< normals that were outliers
    Eigen::Matrix3Xf points = {};  //!< m; where each was found; none where directions are modes
    unsigned rounds = 0;           //!< of outlier removal
};

/** All of the normals, weighted by their planarity. */
Pattern patternOf(const SurfaceNormals& normals);

/** How well a pattern fixes a rotation: eigenvalues (rising, 0 to 1) and eigenvectors of the mean
 * of w (I - n n'). Ground alone gives (0, 1, 1), with the vertical first. */
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axesOf(const Pattern& pattern);

/** In each round, the mean distance on the sphere to the k nearest normals is computed for every
 *  normal; those where it exceeds the mean of all by more than alpha standard deviations are
 *  removed, and with `both_ends` those where it is as much below. (The lower end takes the densest
 *  blobs, the best part of the pattern.) k goes from first_neighbours to last_neighbours. The
 * rounds end where the set is small, or stable. */
Pattern removeOutliers(const SurfaceNormals& normals, const OutlierRemovalOptions& options);
}  // namespace delio::paper
