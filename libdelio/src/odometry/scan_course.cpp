#include "delio/odometry/scan_course.h"

#include <algorithm>
#include <utility>

#include "delio/scan/voxel_grid.h"

namespace delio {
namespace {
/** Static points, the first one in each voxel of `spacing`. */
planes::TimedPoints pickedOf(const scan::PointCloud& cloud, const ScanView& view, double spacing) {
    const auto voxels = scan::numberVoxels(view.points, spacing);
    planes::TimedPoints picked{Eigen::Matrix3Xd(3, voxels.voxels), {}};
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < voxels.ofPoint.size(); ++i) {
        if (voxels.ofPoint[i] != met) continue;
        ++met;
        if (view.dynamic[i]) continue;
        picked.points.col(static_cast<Eigen::Index>(picked.times_s.size())) =
            cloud.points.col(static_cast<Eigen::Index>(i)).cast<double>();
        picked.times_s.push_back(double{cloud.times_s[i]});
    }
    picked.points.conservativeResize(3, static_cast<Eigen::Index>(picked.times_s.size()));
    return picked;
}
}  // namespace

Course evenCourse(const KnownMotion& known, const scan::PointCloud& cloud) {
    constexpr unsigned kParts = 8;
    const auto [least, most] = std::minmax_element(cloud.times_s.begin(), cloud.times_s.end());
    const double start_s = -known.since_s, first_s = std::max(start_s, double{*least}),
                 last_s = std::max(0.0, double{*most});
    // Before the scan one part: of a bend only its mean can be extrapolated, to a scan before.
    std::vector<double> times_s;
    if (first_s > start_s) times_s.push_back(start_s);
    for (unsigned k = 0; k <= (last_s > first_s ? kParts : 0); ++k)
        times_s.push_back(first_s + k * (last_s - first_s) / kParts);
    return Course::even(times_s, known.reference,
                        Motion::of(known.reference.inverse() * known.pose, known.since_s));
}

Course findCourse(const planes::PlaneMap& map, const KnownMotion& known,
                  const scan::PointCloud& cloud, const ScanView& view, const Unevenness& unevenness,
                  double kernel, const PlaneOdometryOptions& options) {
    const double most_m = options.tracker.acceleration * known.since_s * known.since_s;
    return planes::registerCourse(map, pickedOf(cloud, view, options.tracker.scan_spacing),
                                  evenCourse(known, cloud), known.since_s, unevenness.prior(most_m),
                                  kernel, options.registration);
}

std::optional<ScanOnCourse> registerOn(const Course& course, const KnownMotion& known,
                                       const ScanToMap& map, const scan::PointCloud& cloud,
                                       const ScanView& view, const PlaneOdometryOptions& options) {
    ScanView again = undistorted(cloud, course.seenFrom(0));
    again.dynamic = view.dynamic;
    thin(again, options.tracker.map_spacing, options.tracker.scan_spacing);
    again.coarse = scan::firstOfVoxels(again.fine, options.tracker.point_spacing).cast<double>();
    const auto placed = map.place(again.coarse, course.at(0), options.points.least_kernel);
    if (!placed.valid) return {};
    auto estimate = map.refine(again, placed, known.pose, known.reference);
    return ScanOnCourse{std::move(again), std::move(estimate), course, placed.share};
}

Onward::Onward(const Course& course, double over_s)
    : end_s_(course.times_s().back()),
      end_(course.poses().back()),
      motion_(Motion::of(course.at(end_s_ - over_s).inverse() * end_, over_s)) {}
}  // namespace delio
