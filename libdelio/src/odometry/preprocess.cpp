#include "odometry/preprocess.h"
#include "odometry/tuning.h"

#include <mrpt/core/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/portable_math.h"
#include "odometry/deskew.h"

#include "odometry/rings.h"

namespace delio::odometry {
namespace {
/** Middle of the times, without the few that are outliers. */
float middleOf(const std::vector<float>& times_s) {
    constexpr double kOutliers = 0.01;  // at either end
    const auto last = static_cast<std::ptrdiff_t>(times_s.size()) - 1,
               low = static_cast<std::ptrdiff_t>(kOutliers * static_cast<double>(last)),
               high = last - low;
    if (std::is_sorted(times_s.begin(), times_s.end()))
        return (times_s[static_cast<std::size_t>(low)] + times_s[static_cast<std::size_t>(high)]) /
               2;
    std::vector<float> sorted = times_s;
    const auto first = sorted.begin();
    std::nth_element(first, first + high, sorted.end());
    std::nth_element(first, first + low, first + high);
    return (first[low] + first[high]) / 2;
}

/** Adds `angle` (radians) to the elevation of each point. */
void raise(double angle, Eigen::Matrix3Xf& points) {
    const auto c = static_cast<float>(portable::cos(angle)),
               s = static_cast<float>(portable::sin(angle));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        auto point = points.col(i);
        const float flat = std::sqrt(point.x() * point.x() + point.y() * point.y());
        const float flatNow = c * flat - s * point.z();
        if (flat > 0) point.head<2>() *= flatNow / flat;
        point.z() = s * flat + c * point.z();
    }
}
}  // namespace

std::pair<float, float> rangeOf(const std::vector<float>& times_s) {
    const Eigen::Map<const Eigen::ArrayXf> all(times_s.data(),
                                               static_cast<Eigen::Index>(times_s.size()));
    return {all.minCoeff(), all.maxCoeff()};
}

std::pair<double, double> endsOf(const PointCloud& cloud) {
    if (cloud.times_s.empty()) return {0, 0};
    const auto [first, last] = rangeOf(cloud.times_s);
    return {std::min(0.0, double{first}), std::max(0.0, double{last})};
}

void countFromMiddle(PointCloud& cloud) {
    if (cloud.times_s.empty()) return;
    constexpr float kThere_s = 2e-3F;  // such a stamp is in the middle
    const float middle_s = middleOf(cloud.times_s);
    if (std::abs(middle_s) < kThere_s) return;
    for (float& time_s : cloud.times_s) time_s -= middle_s;
    cloud.stamp_s = -double{middle_s};
}

PointCloud preprocess(const Scan& scan, const PreprocessOptions& options) {
    requireConsistent(scan);
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    const auto near = static_cast<float>(options.min_range * options.min_range);
    const auto far = static_cast<float>(options.max_range * options.max_range);

    // All at once first, in a plain loop: vector instructions.
    const auto all = static_cast<Eigen::Index>(x.size());
    Eigen::ArrayXf squaredRanges(all);
    for (Eigen::Index i = 0; i < all; ++i) {
        const float px = x.data()[i], py = y.data()[i], pz = z.data()[i];
        squaredRanges[i] = px * px + (py * py + pz * pz);
    }
    constexpr float kLongest_s = 1;  // from a stamp to a point of its scan
    const bool timed = options.deskew && !scan.times_s.empty(), numbered = !scan.rings.empty();
    PointCloud cloud;
    cloud.points.resize(3, all);
    cloud.indices.resize(x.size());
    if (numbered) cloud.rings.resize(x.size());
    if (timed) cloud.times_s.resize(x.size());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < all; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const bool isTimed = !timed || std::abs(scan.times_s[k]) <= kLongest_s;
        const bool isInRange =
            squaredRanges[i] > 0 && squaredRanges[i] >= near && squaredRanges[i] <= far;
        if (!isInRange || !isTimed) {
            const bool finite = std::isfinite(x[k]) && std::isfinite(y[k]) && std::isfinite(z[k]);
            ++(finite && isTimed ? cloud.outOfRange : cloud.notFinite);
            continue;
        }
        float* const point = cloud.points.data() + 3 * kept;
        point[0] = x[k];
        point[1] = y[k];
        point[2] = z[k];
        if (numbered) cloud.rings[static_cast<std::size_t>(kept)] = scan.rings[k];
        if (timed) cloud.times_s[static_cast<std::size_t>(kept)] = scan.times_s[k];
        cloud.indices[static_cast<std::size_t>(kept)] = static_cast<std::uint32_t>(k);
        ++kept;
    }
    cloud.indices.resize(static_cast<std::size_t>(kept));
    if (numbered) cloud.rings.resize(static_cast<std::size_t>(kept));
    if (timed) cloud.times_s.resize(static_cast<std::size_t>(kept));
    cloud.points.conservativeResize(3, kept);
    if (options.vertical_correction_deg != 0)
        raise(options.vertical_correction_deg * M_PI / 180, cloud.points);
    if (options.deskew && scan.times_s.empty() && options.sweep_s > 0)
        cloud.times_s = azimuthTimes(cloud.points, options.sweep_s);
    return cloud;
}

std::string whyNoneIsLeft(const Scan& scan, const PreprocessOptions& options) {
    const std::size_t count = scan.points->size();
    if (count == 0) return "no points";
    if (!preprocess(scan, options).indices.empty()) return "";
    double nearest = INFINITY, farthest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double range = Eigen::Vector3d(scan.points->getPointsBufferRef_x()[i],
                                             scan.points->getPointsBufferRef_y()[i],
                                             scan.points->getPointsBufferRef_z()[i])
                                 .norm();
        if (!(std::isfinite(range) && range > 0)) continue;
        nearest = std::min(nearest, range);
        farthest = std::max(farthest, range);
    }
    const std::string all = "all " + std::to_string(count) + " points are ";
    if (farthest == 0) return all + "NaN or at the sensor";
    if (nearest > options.max_range)
        return all + mrpt::format(
                         "farther than scan.max_range (the nearest: %.3g m): are they in "
                         "metres and relative to the sensor?",
                         nearest);
    if (farthest < options.min_range)
        return all + mrpt::format(
                         "nearer than scan.min_range (the farthest: %.3g m): are they in "
                         "metres?",
                         farthest);
    return "none of the " + std::to_string(count) +
           " points lies between scan.min_range and scan.max_range and has a time";
}

std::vector<std::uint16_t> neighbouringRings(const PointCloud& cloud,
                                             const Eigen::Matrix3f& upright) {
    const Eigen::Matrix3Xf points = upright * cloud.points;
    return cloud.rings.empty() ? ringsOf(points) : ringsFromTop(points, cloud.rings);
}

ScaledOptions atScale(const PlaneOdometryOptions& options, double scale) {
    ScaledOptions scaled;
    static_cast<PlaneOdometryOptions&>(scaled) = options;
    for (const auto& [section, stage] : stagesOf(static_cast<PlaneOdometryOptions&>(scaled)))
        stage->scaleBy(scale);
    for (double* length :
         {&scaled.spacing.map_spacing, &scaled.spacing.scan_spacing, &scaled.spacing.point_spacing,
          &scaled.spacing.first_speed, &scaled.spacing.doubt_spacing, &scaled.localMap.probe,
          &scaled.points.first_kernel, &scaled.points.least_kernel, &scaled.points.converged_m,
          &scaled.map.max_thickness})
        *length *= scale;
    return scaled;
}
}  // namespace delio::odometry
