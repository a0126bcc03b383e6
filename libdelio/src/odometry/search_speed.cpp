#include "odometry/search_speed.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
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
PointCloud standing(const PointCloud& cloud, const Eigen::Matrix3f& upright, Eigen::Index most) {
    const SegmentTuning segments;
    const auto kept = standingPoints(cloud.points, upright, segments.above_ground, segments.radius);
    const auto all = static_cast<Eigen::Index>(kept.size()), stride = strideOf(all, most);
    PointCloud result;
    result.points.resize(3, (all + stride - 1) / stride);
    for (Eigen::Index i = 0; i < result.points.cols(); ++i) {
        const Eigen::Index from = kept[static_cast<std::size_t>(i * stride)];
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

/** Points of a scan at each speed, in the map. */
struct PointsAtSpeeds {
    Eigen::Matrix3Xd atRest, per_mps;

    Eigen::Matrix3Xd at(double speed_mps) const { return atRest + speed_mps * per_mps; }
};

/** The points of each scan if the sensor moved along the unit vector `forward` (sensor's frame). */
std::vector<PointsAtSpeeds> atSpeedsAlong(const Eigen::Vector3d& forward,
                                          const std::vector<MovingScan>& scans) {
    const auto resting = movedAt(Eigen::Vector3d::Zero(), scans), moved = movedAt(forward, scans);
    std::vector<PointsAtSpeeds> points(scans.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
        points[i].atRest = inMap(resting[i]);
        points[i].per_mps = inMap(moved[i]) - points[i].atRest;
    }
    return points;
}

/** Vertical columns about points (metres, the map's frame), at least `reach` wide. */
class Columns {
 public:
    Columns(const Eigen::Matrix3Xd& points, double reach)
        : centre_(points.rowwise().mean()), grid_(reach, kRadius_m), isNear_(grid_.size() + 1, 0) {
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const std::size_t cell = cellOf(points.col(i));
            if (cell < grid_.size())
                grid_.forNeighbours(cell, [&](std::size_t near) { isNear_[near] = 1; });
        }
    }
    /** The points that lie in them. */
    Eigen::Matrix3Xd of(Eigen::Matrix3Xd points) const {
        Eigen::Index count = 0;
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            if (isNear_[cellOf(points.col(i))] != 0) points.col(count++) = points.col(i);
        points.conservativeResize(3, count);
        return points;
    }

 private:
    static constexpr double kRadius_m = 120;

    std::size_t cellOf(const Eigen::Vector3d& point) const {
        const Eigen::Vector3f seen = (point - centre_).cast<float>();
        return grid_.at(seen.x(), seen.y());
    }

    Eigen::Vector3d centre_;
    LevelGrid grid_;
    std::vector<std::uint8_t> isNear_;  //!< of each cell, and of points outside
};

/** Of the last scan's points, whose `sectors` are known, with those of the others. A point counts
 *  the less the farther it is from the nearest one, up to `reach` metres. */
Overlap overlapAt(double speed_mps, const std::vector<PointsAtSpeeds>& scans,
                  const std::vector<int>& sectors, double reach) {
    PointMapOptions options;
    options.voxel_size = 0.5;
    options.spacing = 0.1;
    PointMap map(options);
    const Eigen::Matrix3Xd points = scans.back().at(speed_mps);
    const Columns columns(points, reach);
    for (std::size_t i = 0; i + 1 < scans.size(); ++i) map.add(columns.of(scans[i].at(speed_mps)));
    Overlap overlap;
    const auto found = map.nearestOf(points, reach);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const int sector = sectors[static_cast<std::size_t>(i)];
        ++overlap.count[sector];
        const auto& nearest = found[static_cast<std::size_t>(i)];
        const double off = (nearest.point - points.col(i)).norm() / reach;
        if (nearest.any) overlap.matched[sector] += std::pow(1 - off * off, 2);
    }
    return overlap;
}

constexpr double kStep_mps = 1;  // between two speeds that are compared

/** By how much the share of points that lie on other scans is higher at each speed (row) than at
 *  those about it, in each sector (column). Neither a sector with many points nor one with a high
 *  share, such as a wall or a vehicle that drives along, outvotes the others. */
using Votes = Eigen::Array<double, Eigen::Dynamic, kSectors>;

Votes votesOf(const std::vector<Overlap>& overlaps) {
    constexpr Eigen::Index kAbout = 5;  // speeds to either side
    constexpr double kMost = 0.05, kMany = 100;
    const auto speeds = static_cast<Eigen::Index>(overlaps.size());
    Votes shares(speeds, kSectors), votes = shares;
    Sectors count = Sectors::Zero();
    for (Eigen::Index i = 0; i < speeds; ++i) {
        const Overlap& overlap = overlaps[static_cast<std::size_t>(i)];
        shares.row(i) = overlap.matched / overlap.count.max(1);
        count += overlap.count / static_cast<double>(speeds);
    }
    const Sectors weights = (count / kMany).min(1);
    std::array<double, 2 * kAbout + 1> about{};
    for (Eigen::Index sector = 0; sector < kSectors; ++sector)
        for (Eigen::Index i = 0; i < speeds; ++i) {
            for (Eigen::Index k = -kAbout; k <= kAbout; ++k)
                about[static_cast<std::size_t>(k + kAbout)] =
                    shares(std::clamp<Eigen::Index>(i + k, 0, speeds - 1), sector);
            std::nth_element(about.begin(), about.begin() + kAbout, about.end());
            const double gain = std::min(shares(i, sector) - about[kAbout], kMost);
            votes(i, sector) = weights[sector] / std::max(weights.sum(), 1.) * gain;
        }
    return votes;
}

}  // namespace

void SpeedSearch::clear() {
    scans_.clear();
    axes_.setZero();
    waiting_.reset();
    overlaps_.clear();
    likely_ = {};
}

SpeedSearch::Scans SpeedSearch::groupBefore(std::size_t end) const {
    const auto last = scans_.begin() + static_cast<std::ptrdiff_t>(end);
    return {last - kTogether, last};
}

/** Keeps the groups at whose end the same speed fitted best, and the one that waits. */
void SpeedSearch::forgetOld() {
    const auto kept = std::min(likely_.times, kOften - 1) + (waiting_ ? 1 : 0);
    scans_.erase(scans_.begin(), scans_.end() - static_cast<std::ptrdiff_t>(kept * kTogether));
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
    const Group latest{forward, guess.speed_mps * forward.dot(toSensor * guess.axis),
                       guess.upright};
    if (waiting_) compare(*waiting_, groupBefore(scans_.size() - kTogether));
    waiting_ = latest;
    if (likely_.times + 1 >= kOften) {
        waiting_.reset();
        if (const auto speed_mps = compare(latest, groupBefore(scans_.size()))) {
            auto scans = movedAt(*speed_mps * forward, std::move(scans_));
            clear();
            return scans;
        }
    }
    forgetOld();
    return {};
}

/** At each speed from -most_mps_ on. Empty where too little stands above the ground. */
std::vector<Overlap> SpeedSearch::overlapsOf(const Group& group, Scans scans) const {
    constexpr double kSpacing = 0.1;
    constexpr Eigen::Index kFewest = 100;
    constexpr std::size_t kMost = 2000;
    for (MovingScan& scan : scans) scan.cloud = thinned(scan.cloud, kSpacing);
    scans.back().cloud = standing(scans.back().cloud, group.upright, kMost);
    if (scans.back().cloud.points.cols() < kFewest) return {};
    const auto points = atSpeedsAlong(group.forward, scans);
    const Eigen::Matrix3Xf& last = scans.back().cloud.points;
    std::vector<int> sectors;
    for (Eigen::Index i = 0; i < last.cols(); ++i) sectors.push_back(sectorOf(last.col(i)));
    std::vector<Overlap> overlaps(static_cast<std::size_t>(2 * most_mps_ / kStep_mps) + 1);
    tbb::parallel_for(std::size_t{0}, overlaps.size(), [&](std::size_t i) {
        const double speed_mps = static_cast<double>(i) * kStep_mps - most_mps_;
        overlaps[i] = overlapAt(speed_mps, points, sectors, reach_m_);
    });
    return overlaps;
}

/** How far (m/s) the highest share of points is from the speed with that number, which is near. */
double SpeedSearch::offsetOfPeak(Eigen::Index near) const {
    constexpr Eigen::Index kFar = 2;  // many votes in a row may be the highest possible
    const auto share = [&](Eigen::Index i) {
        return overlaps_[static_cast<std::size_t>(i)].share();
    };
    const auto last = static_cast<Eigen::Index>(overlaps_.size()) - 1;
    Eigen::Index at = near;
    for (Eigen::Index i = std::max<Eigen::Index>(near - kFar, 0); i <= std::min(near + kFar, last);
         ++i)
        if (share(i) > share(at)) at = i;
    const double offset = static_cast<double>(at - near);
    if (at == 0 || at == last) return kStep_mps * offset;
    const double before = share(at - 1), after = share(at + 1),
                 curvature = before - 2 * share(at) + after;
    const bool isPeak = share(at) > before && share(at) >= after;
    return kStep_mps * (offset + (isPeak ? (before - after) / (2 * curvature) : 0));
}

/** The speed of the group, where it is clear and not the present one. */
std::optional<double> SpeedSearch::compare(const Group& group, const Scans& scans) {
    constexpr double kForget = 0.6, kSame_mps = 3, kAlias_m = 0.8, kLeast = 0.01, kClear = 1.4;
    constexpr double kManySectors = 4.5;  // a vehicle that drives along is in one or two
    constexpr double kNoSpeed = std::numeric_limits<double>::infinity();
    const auto now = overlapsOf(group, scans);
    if (now.empty()) {
        overlaps_.clear();
        likely_ = {};
        return {};
    }
    overlaps_.resize(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
        overlaps_[i].count = kForget * overlaps_[i].count + now[i].count;
        overlaps_[i].matched = kForget * overlaps_[i].matched + now[i].matched;
    }
    const Votes votes = votesOf(overlaps_);
    const Eigen::ArrayXd sums = votes.rowwise().sum();
    const auto speedAt = [&](Eigen::Index i) {
        return static_cast<double>(i) * kStep_mps - most_mps_;
    };
    // A sensor's own rings lie on each other where it seems to stand.
    const double duration_s = scans.back().time_s - scans.front().time_s,
                 alias_mps = kAlias_m * (kTogether - 1) / duration_s;
    const auto bestBut = [&](double speed_mps) {
        Eigen::Index best = 0;
        for (Eigen::Index i = 1; i + 1 < sums.size(); ++i)
            if (sums[i] > sums[i - 1] && sums[i] >= sums[i + 1] &&
                std::abs(speedAt(i)) >= alias_mps &&
                std::abs(speedAt(i) - speed_mps) >= kSame_mps &&
                (best == 0 || sums[i] > sums[best]))
                best = i;
        return best;
    };
    const Eigen::Index best = bestBut(kNoSpeed), second = bestBut(speedAt(best));
    const double best_mps = speedAt(best);
    const bool isLikely = best > 0 && sums[best] > kLeast &&
                          sums[best] > kClear * (second > 0 ? sums[second] : 0) &&
                          spreadOf(votes.row(best).max(0)) > kManySectors;
    const bool isAgain = std::abs(best_mps - likely_.speed_mps) < kSame_mps;
    likely_ = {best_mps, !isLikely ? 0 : isAgain ? likely_.times + 1 : 1};
    if (likely_.times < kOften || std::abs(best_mps - group.present_mps) < kSame_mps) return {};
    return best_mps + offsetOfPeak(best);
}
}  // namespace delio::odometry
