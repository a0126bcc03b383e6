#include "delio/places/submap.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "odometry/spin_axis.h"

namespace delio::places {
namespace {
/** A standing vehicle adds no path and unlimited scans, so its scans are ignored. */
bool isMuch(const Eigen::Isometry3d& moved) {
    constexpr double kMuch_m = 0.5, kMuch_rad = 0.2;
    return moved.translation().norm() >= kMuch_m || angleOf(moved.linear()) >= kMuch_rad;
}
}  // namespace

std::vector<OptionField> SubmapOptions::fields() const {
    return {{"path", &SubmapOptions::path, "m; path length after which a submap ends", 1, 1e4},
            {"straight", &SubmapOptions::straight,
             "m; distance from its start after which a submap ends", 1, 1e4},
            {"spacing", &SubmapOptions::spacing, "m; distance between points of a submap", 0.05, 2},
            {"radius", &SubmapOptions::radius, "m; points farther from the sensor are ignored", 5,
             1e4}};
}

void PathSegment::add(const Increment& increment, double moved_m) {
    path_m += moved_m;
    variance_m2 += increment.covariance.diagonal().head<3>().maxCoeff();
    variance_rad2 += increment.covariance.diagonal().tail<3>().maxCoeff();
}

PathSegment PathSegment::operator+(const PathSegment& other) const {
    return {path_m + other.path_m, variance_m2 + other.variance_m2,
            variance_rad2 + other.variance_rad2};
}

PathSegment between(const PathSegment& a, const PathSegment& b) {
    return {std::abs(a.path_m - b.path_m), std::abs(a.variance_m2 - b.variance_m2),
            std::abs(a.variance_rad2 - b.variance_rad2)};
}

std::vector<Eigen::Isometry3d> levelFrames(const std::vector<Submap>& submaps,
                                           const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<Eigen::Isometry3d> level;
    level.reserve(submaps.size());
    for (const auto& submap : submaps)
        level.push_back(poses[submap.key] * isometry(submap.level, Eigen::Vector3d::Zero()));
    return level;
}

std::future<Submap> SubmapBuilder::add(std::size_t node, const Increment& increment,
                                       const Eigen::Matrix3Xf& points, const Eigen::Vector3d& up) {
    std::future<Submap> ended;
    if (isComplete() || isBeyondGap(increment)) ended = end();
    Part part{node,
              Eigen::Isometry3d::Identity(),
              {},
              up,
              parts_.empty() ? ended_ : parts_.back().driven};
    Eigen::Isometry3d moved = increment.pose;
    if (!parts_.empty()) {
        part.pose = parts_.back().pose * increment.pose;
        const auto seen = std::find_if(parts_.rbegin(), parts_.rend(),
                                       [](const Part& other) { return other.showsMore; });
        if (seen != parts_.rend()) moved = seen->pose.inverse() * part.pose;
    }
    part.showsMore = parts_.empty() || isMuch(moved);
    if (part.showsMore) part.points = points;
    if (node > 0) part.driven.add(increment, part.showsMore ? moved.translation().norm() : 0);
    parts_.push_back(std::move(part));
    return ended;
}

bool SubmapBuilder::isBeyondGap(const Increment& increment) const {
    constexpr double kGap_m = 2;
    const auto seen = std::find_if(parts_.rbegin(), parts_.rend(),
                                   [](const Part& part) { return part.points.cols() > 0; });
    if (seen == parts_.rend()) return false;
    PathSegment since = between(parts_.back().driven, seen->driven);
    since.add(increment, 0);
    return since.variance_m2 > kGap_m * kGap_m;
}

bool SubmapBuilder::isComplete() const {
    if (parts_.empty()) return false;
    const auto &begin = parts_.front(), &end = parts_.back();
    return end.driven.path_m - begin.driven.path_m >= options_.path ||
           (end.pose.translation() - begin.pose.translation()).norm() >= options_.straight;
}

Submap SubmapBuilder::merged(const std::vector<Part>& parts, const SubmapOptions& options) {
    const Part& key = parts[parts.size() / 2];
    Submap submap;
    submap.first = parts.front().node;
    submap.key = key.node;
    submap.last = parts.back().node;
    submap.driven = key.driven;
    submap.level = odometry::turnedUp(key.up).cast<double>().transpose();
    Eigen::Index count = 0, used = 0;
    for (const auto& part : parts) count += part.points.cols();
    Eigen::Matrix3Xf all(3, count);
    for (const Part& part : parts) {
        const Eigen::Isometry3f placed =
            (submap.level.transpose() * (key.pose.inverse() * part.pose)).cast<float>();
        for (Eigen::Index k = 0; k < part.points.cols(); ++k)
            if (part.points.col(k).norm() <= options.radius)
                all.col(used++) = placed * part.points.col(k);
    }
    constexpr Eigen::Index kEnough = 30000;
    submap.points =
        firstOfVoxels(all.leftCols(used), options.spacing, options.spacing / 2, kEnough);
    return submap;
}

std::future<Submap> SubmapBuilder::end() {
    ended_ = parts_.back().driven;
    return std::async(
        std::launch::deferred,
        [parts = std::exchange(parts_, {}), options = options_] { return merged(parts, options); });
}

std::future<Submap> SubmapBuilder::finish() {
    if (parts_.empty()) return {};
    return end();
}
}  // namespace delio::places
