#include "delio/odometry/scan_view.h"

#include "delio/scan/deskew.h"
#include "delio/scan/voxel_grid.h"

namespace delio {
ScanView undistorted(const scan::PointCloud& cloud, const Course& course) {
    ScanView view;
    view.points =
        cloud.times_s.empty() ? cloud.points : scan::deskew(cloud.points, cloud.times_s, course);
    view.dynamic.resize(static_cast<std::size_t>(view.points.cols()));
    return view;
}

Eigen::Matrix3Xf unmarked(const Eigen::Matrix3Xf& points, const std::vector<std::uint8_t>& marks) {
    Eigen::Matrix3Xf result(3, points.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (!marks[static_cast<std::size_t>(i)]) result.col(kept++) = points.col(i);
    result.conservativeResize(3, kept);
    return result;
}

void thin(ScanView& view, double map_spacing, double scan_spacing) {
    view.fine = scan::voxelCentroids(unmarked(view.points, view.dynamic), map_spacing);
    view.thinned = scan::voxelCentroids(view.fine, scan_spacing).cast<double>();
}
}  // namespace delio
