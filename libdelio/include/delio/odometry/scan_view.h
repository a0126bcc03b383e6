#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "delio/core/course.h"
#include "delio/scan/preprocess.h"

namespace delio {
/** A scan as it is registered against a map: undistorted, in the sensor's frame at the stamp,
 *  dynamic objects left out of the thinned points. Metres. */
struct ScanView {
    Eigen::Matrix3Xf points;            //!< all
    std::vector<std::uint8_t> dynamic;  //!< 1 for each of them that belongs to a dynamic object
    Eigen::Matrix3Xf fine;              //!< thinned for the map
    Eigen::Matrix3Xd thinned;           //!< thinned for registration by planes
    Eigen::Matrix3Xd coarse;            //!< thinned for registration by points, all of the scan
};

/** Undistorted by `course` (see scan::deskew()) where the points have times; not thinned yet,
 *  nothing dynamic. */
ScanView undistorted(const scan::PointCloud& cloud, const Course& course);

/** The columns of `points` that are not marked. */
Eigen::Matrix3Xf unmarked(const Eigen::Matrix3Xf& points, const std::vector<std::uint8_t>& marks);

/** Thins the static points: centroids of voxels of `map_spacing` for the map, and of these in turn
 *  by `scan_spacing` for registration. */
void thin(ScanView& view, double map_spacing, double scan_spacing);
}  // namespace delio
