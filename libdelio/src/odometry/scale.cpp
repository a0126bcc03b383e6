#include "delio/odometry/scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace delio {
double scaleOf(const Scan& scan) {
    constexpr double kShare = 0.9, kStreet_m = 16, kLeast = 0.25;
    constexpr std::size_t kEnough = 10000;
    std::vector<float> ranges;
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    for (std::size_t i = 0; i < x.size(); i += 1 + x.size() / kEnough) {
        const float range = Eigen::Vector3f(x[i], y[i], z[i]).norm();
        if (std::isfinite(range) && range > 0) ranges.push_back(range);
    }
    if (ranges.empty()) return 1;
    const auto most = ranges.begin() +
                      static_cast<std::ptrdiff_t>(kShare * static_cast<double>(ranges.size() - 1));
    std::nth_element(ranges.begin(), most, ranges.end());
    return std::clamp(static_cast<double>(*most) / kStreet_m, kLeast, 1.0);
}

PlaneOdometryOptions atScale(PlaneOdometryOptions options, double scale) {
    for (double* length :
         {&options.scan.min_range, &options.tracker.map_spacing, &options.tracker.scan_spacing,
          &options.tracker.point_spacing, &options.tracker.first_speed,
          &options.tracker.doubt_spacing, &options.scanToMap.probe, &options.pointMap.voxel_size,
          &options.pointMap.spacing, &options.points.first_kernel, &options.points.least_kernel,
          &options.points.last_kernel, &options.points.converged_m, &options.map.voxel_size,
          &options.map.max_thickness, &options.registration.last_kernel,
          &options.registration.search_step})
        *length *= scale;
    return options;
}
}  // namespace delio
