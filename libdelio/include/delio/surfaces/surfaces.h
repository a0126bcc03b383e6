#pragma once
#include "delio/surfaces/bilateral_filter.h"
#include "delio/surfaces/normals.h"

namespace delio::surfaces {
/** Normals of `points` (metres, the sensor at the origin), filtered bilaterally: section III-A as a
 *  whole. */
inline SurfaceNormals surfacesOf(const Eigen::Matrix3Xf& points, const NormalsOptions& normals,
                                 const BilateralFilterOptions& bilateral) {
    return filterBilaterally(estimateNormals(points, normals), bilateral);
}
}  // namespace delio::surfaces
