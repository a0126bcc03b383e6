#include "odometry/deskew.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/scan_trajectory.h"
#include "odometry/above_ground.h"
#include "odometry/tuning.h"

namespace delio::odometry {
std::vector<float> azimuthTimes(const Eigen::Matrix3Xf& points, double sweep_s) {
    std::vector<float> times_s(static_cast<std::size_t>(points.cols()));
    const auto perRadian = static_cast<float>(-sweep_s / (2 * M_PI));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        times_s[static_cast<std::size_t>(i)] = perRadian * std::atan2(points(1, i), points(0, i));
    return times_s;
}

Eigen::Matrix3Xf deskew(const Eigen::Matrix3Xf& points, const std::vector<float>& times_s,
                        const ScanTrajectory& trajectory) {
    Eigen::Matrix3Xf result(3, points.cols());
    if (points.cols() == 0) return result;
    const auto [least, most] = rangeOf(times_s);
    const PoseTableOf<float> poses(trajectory, double{least}, double{most});
    using Range = tbb::blocked_range<Eigen::Index>;
    constexpr Eigen::Index kTogether = 2048;
    tbb::parallel_for(Range(0, points.cols(), kTogether), [&](const Range& range) {
        for (Eigen::Index i = range.begin(); i != range.end(); ++i)
            result.col(i) = poses.at(times_s[static_cast<std::size_t>(i)]) * points.col(i);
    });
    return result;
}

ScanView undistorted(const PointCloud& cloud, const ScanTrajectory& trajectory) {
    ScanView view;
    view.points =
        cloud.times_s.empty() ? cloud.points : deskew(cloud.points, cloud.times_s, trajectory);
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

void thinForPoints(ScanView& view, const Eigen::Matrix3f& upright, double spacing,
                   bool byStanding) {
    constexpr std::size_t kFewest = 200;
    constexpr Eigen::Index kRings = 3000;  // a ring or two show no height
    const SegmentTuning segments;
    view.coarseColumns = firstsOfVoxels(view.fine, spacing);
    view.coarse = view.fine(Eigen::all, view.coarseColumns).cast<double>();
    view.levelColumns.clear();
    view.level.resize(3, 0);
    if (!byStanding || view.points.cols() < kRings) return;
    const auto standing =
        standingPoints(view.fine, upright, segments.above_ground, segments.radius);
    auto firsts = firstsOfVoxels(view.fine(Eigen::all, standing), spacing / 2);
    if (firsts.size() < kFewest) return;
    for (Eigen::Index& column : firsts) column = standing[static_cast<std::size_t>(column)];
    view.levelColumns = std::exchange(view.coarseColumns, std::move(firsts));
    view.level = std::move(view.coarse);
    view.coarse = view.fine(Eigen::all, view.coarseColumns).cast<double>();
}

void thinForMap(ScanView& view, double spacing) {
    view.voxels = numberVoxels(view.points, spacing);
    view.dynamicVoxels.assign(static_cast<std::size_t>(view.voxels.voxels), 0);
    view.fine = centroidsOf(view.points, view.voxels);
}

void numberForPlanes(ScanView& view, double spacing) {
    view.fineVoxels = numberVoxels(view.fine, spacing);
}

namespace {
/** Of the points that are not marked: voxels keep their order. */
VoxelNumbers unmarked(const VoxelNumbers& numbers, const std::vector<std::uint8_t>& marks) {
    constexpr auto kNew = std::numeric_limits<std::uint32_t>::max();
    VoxelNumbers result;
    std::vector<std::uint32_t> renumbered(static_cast<std::size_t>(numbers.voxels), kNew);
    result.ofPoint.reserve(numbers.ofPoint.size());
    for (std::size_t i = 0; i < numbers.ofPoint.size(); ++i) {
        if (marks[i]) continue;
        std::uint32_t& number = renumbered[numbers.ofPoint[i]];
        if (number == kNew) number = static_cast<std::uint32_t>(result.voxels++);
        result.ofPoint.push_back(number);
    }
    return result;
}

/** Those of the columns that are not marked. */
std::vector<Eigen::Index> unmarked(const std::vector<Eigen::Index>& columns,
                                   const std::vector<std::uint8_t>& marks) {
    std::vector<Eigen::Index> result;
    result.reserve(columns.size());
    std::copy_if(columns.begin(), columns.end(), std::back_inserter(result),
                 [&](Eigen::Index column) { return !marks[static_cast<std::size_t>(column)]; });
    return result;
}
}  // namespace

void leaveOutDynamic(ScanView& view, std::vector<std::uint8_t> dynamicVoxels) {
    view.dynamicVoxels = std::move(dynamicVoxels);
    tbb::parallel_invoke(
        [&] {
            for (std::size_t i = 0; i < view.dynamic.size(); ++i)
                view.dynamic[i] = view.dynamicVoxels[view.voxels.ofPoint[i]];
        },
        [&] { view.fine = unmarked(view.fine, view.dynamicVoxels); },
        [&] { view.fineVoxels = unmarked(view.fineVoxels, view.dynamicVoxels); });
}

void thinForPlanes(ScanView& view) {
    view.thinned = centroidsOf(view.fine, view.fineVoxels).cast<double>();
}

std::vector<Eigen::Index> firstsForPlanes(const ScanView& view) {
    const auto firsts = firstsOf(view.voxels);
    std::vector<Eigen::Index> result(static_cast<std::size_t>(view.fineVoxels.voxels));
    auto ofFine = view.fineVoxels.ofPoint.rbegin();
    for (std::size_t voxel = firsts.size(); voxel-- > 0;)
        if (!view.dynamicVoxels[voxel]) result[*ofFine++] = firsts[voxel];
    return result;
}

ScanView undistortedAgain(const PointCloud& cloud, const ScanTrajectory& trajectory,
                          const ScanView& view) {
    ScanView again = undistorted(cloud, trajectory);
    Eigen::Matrix3Xf centroids;
    tbb::parallel_invoke([&] { centroids = centroidsOf(again.points, view.voxels); },
                         [&] {
                             again.dynamic = view.dynamic;
                             again.voxels = view.voxels;
                             again.dynamicVoxels = view.dynamicVoxels;
                             again.fineVoxels = view.fineVoxels;
                             again.coarseColumns = unmarked(view.coarseColumns, view.dynamicVoxels);
                             again.levelColumns = unmarked(view.levelColumns, view.dynamicVoxels);
                         });
    tbb::parallel_invoke(
        [&] {
            again.fine = unmarked(centroids, view.dynamicVoxels);
            thinForPlanes(again);
        },
        [&] {
            again.coarse = centroids(Eigen::all, again.coarseColumns).cast<double>();
            again.level = centroids(Eigen::all, again.levelColumns).cast<double>();
        });
    return again;
}

ScanView undistortedAnew(const PointCloud& cloud, const ScanTrajectory& trajectory,
                         const std::vector<std::uint8_t>& dynamic, double mapSpacing,
                         double planeSpacing) {
    ScanView view = undistorted(cloud, trajectory);
    view.dynamic = dynamic;
    view.fine = voxelCentroids(unmarked(view.points, view.dynamic), mapSpacing);
    numberForPlanes(view, planeSpacing);
    thinForPlanes(view);
    return view;
}
}  // namespace delio::odometry
