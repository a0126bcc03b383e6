#include "odometry/own_vehicle.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/voxel_grid.h"
#include "odometry/tuning.h"

namespace delio::odometry {
using namespace own_vehicle_tuning;

namespace {
/** Voxels by their numbers along the axes, which are far from 0. */
constexpr std::int64_t kHalf = 1 << 20;

std::array<std::int64_t, 3> indicesOf(std::uint64_t voxel) {
    const auto part = [&](unsigned shift) {
        return static_cast<std::int64_t>(voxel >> shift & (2 * kHalf - 1)) - kHalf;
    };
    return {part(42), part(21), part(0)};
}

Eigen::AlignedBox3d boxOf(std::uint64_t voxel) {
    const auto [x, y, z] = indicesOf(voxel);
    const Eigen::Vector3d low(static_cast<double>(x), static_cast<double>(y),
                              static_cast<double>(z));
    return {kVoxel_m * low, kVoxel_m * (low + Eigen::Vector3d::Ones())};
}

template <typename Visit>
void forNeighbours(std::uint64_t voxel, const Visit& visit) {
    const auto [x, y, z] = indicesOf(voxel);
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
        for (std::int64_t j = y - 1; j <= y + 1; ++j)
            for (std::int64_t k = z - 1; k <= z + 1; ++k) visit(voxelKey(i, j, k));
}
}  // namespace

void OwnVehicle::add(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                     const Eigen::Isometry3d& pose) {
    if ((pose.translation() - latest_).norm() < kStep_m) return;
    latest_ = pose.translation();
    std::vector<Eigen::Index> near;
    std::vector<float> heights;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (points.col(i).squaredNorm() > kReach_m * kReach_m) continue;
        near.push_back(i);
        heights.push_back(upright.row(2).dot(points.col(i)));
    }
    if (near.empty()) return;
    auto sorted = heights;
    const auto low = sorted.begin() +
                     static_cast<std::ptrdiff_t>(kGroundShare * static_cast<double>(sorted.size()));
    std::nth_element(sorted.begin(), low, sorted.end());
    ++scans_;
    for (std::size_t i = 0; i < near.size(); ++i) {
        if (heights[i] <= *low + kAboveGround_m) continue;
        const Voxel voxel = voxelKey(points.col(near[i]).cast<double>(), kVoxel_m);
        const std::size_t number = numbers_.insert(voxel);
        if (number == counts_.size()) counts_.push_back({voxel, 0, 0});
        Count& count = counts_[number];
        if (std::exchange(count.latest, scans_) != scans_) ++count.scans;
    }
    if (scans_ >= kScans) judge();
}

/** Voxels of pieces that end before reach and are there in nearly all scans. A piece is connected
 *  by voxels that have points often. */
std::set<OwnVehicle::Voxel> OwnVehicle::steady() const {
    std::set<Voxel> often, found;
    for (const Count& count : counts_)
        if (count.scans >= kOften * kScans) often.insert(count.voxel);
    while (!often.empty()) {
        std::vector<Voxel> piece = {*often.begin()};
        often.erase(often.begin());
        Eigen::AlignedBox3d box;
        bool isBounded = true;
        std::size_t always = 0;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const Eigen::AlignedBox3d own = boxOf(piece[i]);
            box.extend(own);
            isBounded = isBounded && own.center().norm() < kReach_m - 2 * kVoxel_m;
            always += counts_[numbers_.find(piece[i])].scans >= kAlways * kScans;
            forNeighbours(piece[i], [&](Voxel other) {
                if (often.erase(other) > 0) piece.push_back(other);
            });
        }
        if (!isBounded || box.sizes().maxCoeff() > kLongest_m || 2 * always < piece.size())
            continue;
        found.insert(piece.begin(), piece.end());
    }
    return found;
}

/** Other vehicles keep their distance for a while: what is found has to be found twice in a row. */
void OwnVehicle::judge() {
    const auto now = steady();
    for (const Voxel voxel : now) {
        if (before_.count(voxel) == 0) continue;
        box_.extend(boxOf(voxel));
        forNeighbours(voxel, [&](Voxel other) { own_.insert(other); });
    }
    before_ = now;
    counts_.clear();
    numbers_.clear();
    scans_ = 0;
}

PointCloud OwnVehicle::without(PointCloud cloud) const {
    if (own_.empty()) return cloud;
    const auto isOwn = [&](Eigen::Index i) {
        const Eigen::Vector3d point = cloud.points.col(i).cast<double>();
        return point.norm() < kReach_m && own_.count(voxelKey(point, kVoxel_m)) > 0;
    };
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
        if (isOwn(i)) continue;
        const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(kept++);
        cloud.points.col(kept - 1) = cloud.points.col(i);
        cloud.indices[to] = cloud.indices[from];
        if (!cloud.rings.empty()) cloud.rings[to] = cloud.rings[from];
        if (!cloud.times_s.empty()) cloud.times_s[to] = cloud.times_s[from];
    }
    const auto rest = static_cast<std::size_t>(kept);
    cloud.outOfRange += cloud.indices.size() - rest;
    cloud.points.conservativeResize(3, kept);
    cloud.indices.resize(rest);
    if (!cloud.rings.empty()) cloud.rings.resize(rest);
    if (!cloud.times_s.empty()) cloud.times_s.resize(rest);
    return cloud;
}
}  // namespace delio::odometry
