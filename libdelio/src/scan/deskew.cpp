#include "delio/scan/deskew.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "delio/core/pose_table.h"

namespace delio::scan {
std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s) {
    std::vector<float> times_s(static_cast<std::size_t>(points.cols()));
    const auto perRadian = static_cast<float>(-sweep_s / (2 * M_PI));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        times_s[static_cast<std::size_t>(i)] = perRadian * std::atan2(points(1, i), points(0, i));
    return times_s;
}

Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const Course& course) {
    Eigen::Matrix3Xf result(3, points.cols());
    if (points.cols() == 0) return result;
    const auto [least, most] = std::minmax_element(times_s.begin(), times_s.end());
    const PoseTable poses(course, double{*least}, double{*most});
    tbb::parallel_for(Eigen::Index{0}, points.cols(), [&](Eigen::Index i) {
        const double time_s = double{times_s[static_cast<std::size_t>(i)]};
        result.col(i) = poses.at(time_s).cast<float>() * points.col(i);
    });
    return result;
}
}  // namespace delio::scan
