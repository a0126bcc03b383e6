#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "delio/core/odometry_options.h"
#include "paper/outlier_removal.h"

namespace delio::paper {
/** A place on the unit sphere where normals are densest. */
struct Mode {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  //!< unit
    std::size_t support = 0;                               //!< normals in its window
};

/** The modes of the density of `directions` (unit vectors), the best supported first: mean shift
 *  with a Gaussian kernel in the tangent plane, from every seed of a grid over the whole sphere, in
 *  a conical window of apex angle `window_deg`, until it stands still; equal ones are merged. */
std::vector<Mode> seekModes(const Eigen::Matrix3Xf& directions, const MeanShiftOptions& options);

/** True where a pattern is too small, or leaves an axis open as the ground alone does. */
bool needsModes(const Pattern& pattern, const MeanShiftOptions& options);

/** The pattern of the normals in a ball about each mode: outliers removed mode by mode (of all
 *  together the small modes would go), then one direction a cell of the sphere, so that the ground
 *  with its many normals does not outweigh the rest. */
Pattern patternOfModes(const SurfaceNormals& normals, const std::vector<Mode>& modes,
                       const MeanShiftOptions& options, const OutlierRemovalOptions& outliers);
}  // namespace delio::paper
