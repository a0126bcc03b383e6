#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "delio/core/stage_options.h"
#include "delio/paper/outlier_removal.h"

namespace delio::paper {
/** Section III-C: where too little of the pattern is left, the modes of the normals' density are
 *  sought, so that small structures are kept beside the ground. The paper gives no numbers. */
struct MeanShiftOptions : public StageOptions {
    unsigned min_pattern = 500;
    double min_observability = 0.01;
    double seed_spacing_deg = 10;
    double window_deg = 20;
    unsigned max_iterations = 50;
    double converged_deg = 0.01;
    double merge_deg = 5;
    unsigned min_support = 10;
    double ball_deg = 6;
    double cell_deg = 1;

 protected:
    std::vector<OptionField> fields() const override;
};

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
Pattern patternOfModes(const surfaces::SurfaceNormals& normals, const std::vector<Mode>& modes,
                       const MeanShiftOptions& options, const OutlierRemovalOptions& outliers);
}  // namespace delio::paper
