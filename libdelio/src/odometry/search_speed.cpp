#include "odometry/search_speed.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/voxel_grid.h"
#include "odometry/above_ground.h"
#include "odometry/deskew.h"
#include "odometry/point_map.h"
#include "odometry/tuning.h"

namespace delio::odometry {
namespace {
/** The scans, oldest first, if the sensor moved at `velocity` (m/s, sensor's frame). The last one
 *  stays where it is; rotations stay. */
std::vector<MovingScan> movedAt(const Eigen::Vector3d& velocity, std::vector<MovingScan> scans) {
    const Eigen::Isometry3d last = scans.back().trajectory.at(0);
    const auto onward = [&](const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                            double duration_s) -> Eigen::Vector3d {
        return duration_s / 2 * (from.linear() * velocity + to.linear() * velocity);
    };
    Eigen::Isometry3d next = last;
    double next_s = scans.back().time_s;
    for (auto scan = scans.rbegin(); scan != scans.rend(); ++scan) {
        Eigen::Isometry3d middle = scan->trajectory.at(0);
        middle.translation() = next.translation() + onward(next, middle, scan->time_s - next_s);
        auto poses = scan->trajectory.poses();
        const auto& times_s = scan->trajectory.times_s();
        for (std::size_t i = 0; i < poses.size(); ++i)
            poses[i].translation() = middle.translation() + onward(middle, poses[i], times_s[i]);
        scan->trajectory = {times_s, poses};
        next = middle;
        next_s = scan->time_s;
    }
    return scans;
}

/** The first point of each voxel. */
PointCloud thinned(const PointCloud& cloud, double spacing) {
    const VoxelNumbers voxels = numberVoxels(cloud.points, spacing);
    PointCloud result;
    result.points.resize(3, voxels.voxels);
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (Eigen::Index{voxels.ofPoint[k]} != kept) continue;
        result.points.col(kept++) = cloud.points.col(i);
        if (!cloud.times_s.empty()) result.times_s.push_back(cloud.times_s[k]);
    }
    return result;
}

/** At most `most` of those that stand above the ground, evenly over the scan. */
PointCloud standing(const PointCloud& cloud, const Eigen::Matrix3f& upright, std::size_t most) {
    const SegmentTuning segments;
    const auto heights = heightsAboveGround(upright * cloud.points, segments.radius);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < cloud.points.cols(); ++i)
        if (heights[static_cast<std::size_t>(i)] > segments.above_ground) kept.push_back(i);
    const std::size_t stride = std::max<std::size_t>(1, (kept.size() + most - 1) / most);
    PointCloud result;
    result.points.resize(3, static_cast<Eigen::Index>((kept.size() + stride - 1) / stride));
    for (Eigen::Index i = 0; i < result.points.cols(); ++i) {
        const Eigen::Index from = kept[static_cast<std::size_t>(i) * stride];
        result.points.col(i) = cloud.points.col(from);
        if (!cloud.times_s.empty())
            result.times_s.push_back(cloud.times_s[static_cast<std::size_t>(from)]);
    }
    return result;
}

Eigen::Matrix3Xd inMap(const MovingScan& scan) {
    const Eigen::Isometry3d pose = scan.trajectory.at(0);
    const auto points =
        undistorted(scan.cloud, scan.trajectory.seenFrom(0)).points.cast<double>().eval();
    return (pose.linear() * points).colwise() + pose.translation();
}

int sectorOf(const Eigen::Vector3f& point) {
    const double turn = std::atan2(point.y(), point.x()) / (2 * M_PI) + 0.5;
    return std::min(static_cast<int>(turn * Overlap::kSectors), Overlap::kSectors - 1);
}

/** A point counts the less the farther it is from the nearest one, up to `reach` metres. */
Overlap overlapOf(const std::vector<MovingScan>& scans, double reach) {
    PointMapOptions options;
    options.voxel_size = 0.5;
    options.spacing = 0.1;
    PointMap map(options);
    for (std::size_t i = 0; i + 1 < scans.size(); ++i) map.add(inMap(scans[i]));
    const Eigen::Matrix3Xf& asSeen = scans.back().cloud.points;
    const Eigen::Matrix3Xd points = inMap(scans.back());
    Overlap overlap;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const int sector = sectorOf(asSeen.col(i));
        ++overlap.count[sector];
        const auto nearest = map.nearest(points.col(i), reach);
        const double off = (nearest.point - points.col(i)).norm() / reach;
        if (nearest.any) overlap.matched[sector] += std::pow(1 - off * off, 2);
    }
    return overlap;
}

/** A speed at which more points lie on the others than at those about it. */
struct Peak {
    int at = 0;
    int before = 0, after = 0;  //!< the lowest shares to either side, up to where more points do
    double prominence = 0;      //!< above the higher one of these
};

std::vector<Peak> peaksOf(const std::vector<double>& shares) {
    const auto count = static_cast<int>(shares.size());
    const auto shareOf = [&](int i) { return shares[static_cast<std::size_t>(i)]; };
    std::vector<Peak> peaks;
    for (int i = 1; i + 1 < count; ++i) {
        if (shareOf(i) <= shareOf(i - 1) || shareOf(i) < shareOf(i + 1)) continue;
        Peak peak{i, i, i};
        for (int k = i; k >= 0 && shareOf(k) <= shareOf(i); --k)
            if (shareOf(k) < shareOf(peak.before)) peak.before = k;
        for (int k = i; k < count && shareOf(k) <= shareOf(i); ++k)
            if (shareOf(k) < shareOf(peak.after)) peak.after = k;
        peak.prominence = shareOf(i) - std::max(shareOf(peak.before), shareOf(peak.after));
        peaks.push_back(peak);
    }
    return peaks;
}

/** How many sectors contribute to the peak: a vehicle that drives along is in one or two. */
double sectorsOf(const Peak& peak, const std::vector<Overlap>& overlaps) {
    const auto shares = [&](int i) {
        const Overlap& overlap = overlaps[static_cast<std::size_t>(i)];
        return (overlap.matched / overlap.count.max(1)).eval();
    };
    const Overlap::Sectors gain = shares(peak.at) - shares(peak.before).max(shares(peak.after)),
                           &count = overlaps[static_cast<std::size_t>(peak.at)].count;
    const Overlap::Sectors points = (gain * count).max(0);
    return points.square().sum() > 0 ? std::pow(points.sum(), 2) / points.square().sum() : 0;
}

/** Of the speeds that `isPossible`, those with the two highest peaks. */
struct Peaks {
    Peak best, second;
};

template <typename IsPossible>
Peaks highestOf(const std::vector<Overlap>& overlaps, const IsPossible& isPossible) {
    std::vector<double> shares;
    shares.reserve(overlaps.size());
    for (const Overlap& overlap : overlaps) shares.push_back(overlap.share());
    Peaks highest;
    for (const Peak& peak : peaksOf(shares)) {
        if (!isPossible(peak.at)) continue;
        if (peak.prominence > highest.best.prominence)
            highest.second = std::exchange(highest.best, peak);
        else if (peak.prominence > highest.second.prominence)
            highest.second = peak;
    }
    return highest;
}

constexpr double kStep_mps = 1;      // between two speeds that are compared
constexpr double kLikely = 0.015;    // prominence of a peak that may be the right one
constexpr double kClear = 0.04;      // and of one that few scans show
constexpr double kFewSectors = 3.5;  // a vehicle that drives along is in one or two
}  // namespace

void SpeedSearch::clear() {
    scans_.clear();
    axes_.setZero();
    overlaps_.clear();
    likely_ = {};
}

std::optional<std::vector<MovingScan>> SpeedSearch::add(MovingScan scan, const Guess& guess) {
    constexpr double kSameWay = 0.95;  // cosine
    const Eigen::Matrix3d toSensor = scan.trajectory.at(0).linear().transpose();
    Eigen::Vector3d axis = toSensor * guess.axis;
    if (axis.dot(axes_) < 0) axis = -axis;
    if (axis.dot(axes_) < kSameWay * axes_.norm()) clear();
    axes_ += axis;
    scans_.push_back(std::move(scan));
    if (scans_.size() % kTogether != 0) return {};
    const Eigen::Vector3d forward = axes_.normalized();
    const double present_mps = guess.speed_mps * forward.dot(toSensor * guess.axis);
    if (const auto speed_mps = speedAlong(forward, present_mps, guess.upright)) {
        auto scans = movedAt(*speed_mps * forward, std::move(scans_));
        clear();
        return scans;
    }
    const auto kept = std::min<std::size_t>(likely_.times, kOften - 1) * kTogether;
    scans_.erase(scans_.begin(), scans_.end() - static_cast<std::ptrdiff_t>(kept));
    return {};
}

/** Of the latest scans, at each speed from -most_mps_ on. Empty where too little stands above the
 *  ground. */
std::vector<Overlap> SpeedSearch::overlapsAlong(const Eigen::Vector3d& forward,
                                                const Eigen::Matrix3f& upright) const {
    constexpr double kSpacing = 0.1;
    constexpr Eigen::Index kFewest = 100;
    constexpr std::size_t kMost = 2000;
    std::vector<MovingScan> scans(scans_.end() - kTogether, scans_.end());
    for (MovingScan& scan : scans) scan.cloud = thinned(scan.cloud, kSpacing);
    scans.back().cloud = standing(scans.back().cloud, upright, kMost);
    if (scans.back().cloud.points.cols() < kFewest) return {};
    std::vector<Overlap> overlaps(static_cast<std::size_t>(2 * most_mps_ / kStep_mps) + 1);
    tbb::parallel_for(std::size_t{0}, overlaps.size(), [&](std::size_t i) {
        const double speed_mps = static_cast<double>(i) * kStep_mps - most_mps_;
        overlaps[i] = overlapOf(movedAt(speed_mps * forward, scans), reach_m_);
    });
    return overlaps;
}

std::optional<double> SpeedSearch::speedAlong(const Eigen::Vector3d& forward, double present_mps,
                                              const Eigen::Matrix3f& upright) {
    constexpr double kForget = 0.6, kSame_mps = 3, kAlias_m = 0.8;
    const auto now = overlapsAlong(forward, upright);
    if (now.empty()) {
        clear();
        return {};
    }
    overlaps_.resize(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
        overlaps_[i].count = kForget * overlaps_[i].count + now[i].count;
        overlaps_[i].matched = kForget * overlaps_[i].matched + now[i].matched;
    }
    const auto speedAt = [&](int i) { return i * kStep_mps - most_mps_; };
    const auto isSame = [](double a_mps, double b_mps) {
        return std::abs(a_mps - b_mps) < kSame_mps;
    };
    // A sensor's own rings lie on each other where it seems to stand.
    const double duration_s = scans_.back().time_s - (scans_.end() - kTogether)->time_s,
                 alias_mps = kAlias_m * (kTogether - 1) / duration_s;
    const auto isPossible = [&](int i) {
        return std::abs(speedAt(i)) >= alias_mps && !isSame(speedAt(i), present_mps);
    };
    const auto [best, second] = highestOf(overlaps_, isPossible);
    const double best_mps = speedAt(best.at);
    const bool isLikely = best.prominence > kLikely && second.prominence < best.prominence / 2 &&
                          sectorsOf(best, overlaps_) > kFewSectors &&
                          isSame(best_mps, speedAt(highestOf(now, isPossible).best.at));
    const bool isAgain = isSame(best_mps, likely_.speed_mps);
    likely_ = {best_mps, !isLikely ? 0 : isAgain ? likely_.times + 1 : 1};
    const bool isClear = best.prominence > kClear && second.prominence < best.prominence / 3;
    if (likely_.times < (isClear ? kOften - 1 : kOften)) return {};

    const auto shareAt = [&](int i) { return overlaps_[static_cast<std::size_t>(i)].share(); };
    const auto present = static_cast<int>(std::lround((present_mps + most_mps_) / kStep_mps));
    const bool isPresentShown = std::abs(present_mps) >= alias_mps && present >= 0 &&
                                present < static_cast<int>(overlaps_.size()) &&
                                shareAt(best.at) < shareAt(present) + kClear / 2;
    if (isPresentShown) return {};
    const double before = shareAt(best.at - 1), after = shareAt(best.at + 1);
    return best_mps + kStep_mps * (before - after) / (2 * (before - 2 * shareAt(best.at) + after));
}
}  // namespace delio::odometry
