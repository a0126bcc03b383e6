#pragma once
#include "delio/core/stage_options.h"
#include "delio/surfaces/normals.h"

namespace delio::surfaces {
/** Section III-A: "bilateral filtering on the surface normals is applied". The paper gives no
 *  numbers. */
struct BilateralFilterOptions : public StageOptions {
    unsigned neighbours = 6;
    double distance_sigma = 0.5;
    double angle_sigma_deg = 10;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Each normal becomes the mean of those found nearest in space and its own, weighted by planarity
 *  and by Gaussians of their distance in space and of their angle to it: noise is averaged within a
 *  surface, edges between surfaces stay. Points and planarities stay as they are. */
SurfaceNormals filterBilaterally(const SurfaceNormals& normals,
                                 const BilateralFilterOptions& options);
}  // namespace delio::surfaces
