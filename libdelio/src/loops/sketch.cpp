#include "delio/loops/sketch.h"

#include "delio/scan/voxel_grid.h"
#include "delio/surfaces/normals.h"

namespace delio::loops {
namespace {
/** Enough for the directions of walls, at a quarter of the time. */
constexpr double kThinned_m = 0.6;
}  // namespace

Sketch::Sketch(const Eigen::Matrix3Xf& points)
    : azimuths(surfaces::estimateNormals(scan::firstOfVoxels(points, kThinned_m), {})),
      image(points) {}
}  // namespace delio::loops
