#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "delio/core/stage_options.h"

namespace delio::surfaces {
/** Section III-A of the paper leaves the neighbourhood open. Taken from the raw scan, the nearest
 *  neighbours of a near point lie within its range noise, and those of a far one on one ring; the
 *  cloud is therefore thinned to one point a voxel first, and neighbourhoods that are a line (one
 *  ring) or no plane at all are dropped. */
struct NormalsOptions : public StageOptions {
    double voxel_size = 0.4;
    unsigned neighbours = 10;
    double max_radius = 1.5;
    double min_breadth = 0.1;
    double max_thickness = 0.15;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Normals of a cloud, and how they came about. */
struct SurfaceNormals {
    Eigen::Matrix3Xf directions;     //!< unit vectors, turned towards the sensor (the origin)
    Eigen::VectorXf planarity;       //!< 0 (barely a plane) to 1, one per direction
    Eigen::Matrix3Xf points;         //!< metres; where each normal was found
    std::size_t neighbourhoods = 0;  //!< examined
    std::size_t lines = 0;           //!< dropped: one ring, or an edge
    std::size_t rough = 0;           //!< dropped: no plane
};

/** Normals of the surfaces that `points` (metres, the sensor at the origin) were measured on: the
 *  eigenvector of the smallest eigenvalue of the k nearest neighbours' covariance, equation (1). */
SurfaceNormals estimateNormals(const Eigen::Matrix3Xf& points, const NormalsOptions& options);
}  // namespace delio::surfaces
