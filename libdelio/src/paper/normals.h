#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "delio/core/odometry_options.h"

namespace delio::paper {
/** Normals of a cloud, and how they came about. */
struct SurfaceNormals {
    Eigen::Matrix3Xf directions;  //!< unit vectors, turned towards the sensor (the origin)
    Eigen::VectorXf planarity;    //!< 0 (barely a plane) to 1, one per direction
    Eigen::Matrix3Xf points;      //!< metres; where each normal was found
    /** The number of the voxel that each was found in (see VoxelNumbers). */
    Eigen::RowVectorX<Eigen::Index> voxels;
    std::size_t neighbourhoods = 0;  //!< examined
    std::size_t lines = 0;           //!< dropped: one ring, or an edge
    std::size_t rough = 0;           //!< dropped: no plane
};

/** Normals of the surfaces that `points` (metres, the sensor at the origin) were measured on: the
 *  eigenvector of the smallest eigenvalue of the k nearest neighbours' covariance, equation (1).
 *  One normal a voxel; of at most `most` voxels, evenly over their order. */
SurfaceNormals estimateNormals(const Eigen::Matrix3Xf& points, const NormalsOptions& options,
                               Eigen::Index most = std::numeric_limits<Eigen::Index>::max());

/** Each normal becomes the mean of those found nearest in space and its own, weighted by planarity
 *  and by Gaussians of their distance in space and of their angle to it: noise is averaged within a
 *  surface, edges between surfaces stay. Points and planarities stay as they are. */
SurfaceNormals filterBilaterally(const SurfaceNormals& normals,
                                 const BilateralFilterOptions& options);

/** Normals of `points` (metres, the sensor at the origin), filtered bilaterally: section III-A as a
 *  whole. */
inline SurfaceNormals surfacesOf(const Eigen::Matrix3Xf& points, const NormalsOptions& normals,
                                 const BilateralFilterOptions& bilateral) {
    return filterBilaterally(estimateNormals(points, normals), bilateral);
}
}  // namespace delio::paper
