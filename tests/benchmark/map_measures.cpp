#include "map_measures.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/kd_tree.h"
#include "core/voxel_grid.h"

namespace delio {
namespace {
constexpr std::size_t kNeighbours = 20;

Eigen::Matrix3Xf placed(const MapPoints& map, const Poses& poses) {
    Eigen::Matrix3Xf result(3, map.points.cols());
    for (Eigen::Index i = 0; i < map.points.cols(); ++i) {
        const auto& pose = poses[map.scan[static_cast<std::size_t>(i)]];
        result.col(i) = (pose * map.points.col(i).cast<double>()).cast<float>();
    }
    return result;
}

/** Keeps the columns `kept`. */
MapPoints chosen(const MapPoints& all, const std::vector<Eigen::Index>& kept) {
    MapPoints result;
    result.points.resize(3, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) {
        result.points.col(static_cast<Eigen::Index>(i)) = all.points.col(kept[i]);
        result.scan.push_back(all.scan[static_cast<std::size_t>(kept[i])]);
    }
    return result;
}

MapPoints joined(const std::vector<Eigen::Matrix3Xf>& scans) {
    Eigen::Index count = 0;
    for (const auto& points : scans) count += points.cols();
    MapPoints result;
    result.points.resize(3, count);
    Eigen::Index at = 0;
    for (std::size_t s = 0; s < scans.size(); ++s) {
        result.points.middleCols(at, scans[s].cols()) = scans[s];
        result.scan.insert(result.scan.end(), static_cast<std::size_t>(scans[s].cols()), s);
        at += scans[s].cols();
    }
    return result;
}

/** A number that looks random, the same in every run. */
std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

/** Distance of `point` to the plane of the columns `near` of `cloud`; NaN if they are no plane. */
double distanceToPlane(const Eigen::Vector3f& point, const Eigen::Matrix3Xf& cloud,
                       const std::vector<std::uint32_t>& near) {
    constexpr double kFarthest = 1, kFlatness = 0.02, kBreadth = 0.1;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (near.size() < kNeighbours) return kNone;
    const Eigen::Vector3d origin = point.cast<double>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const auto i : near) {
        const Eigen::Vector3d d = cloud.col(static_cast<Eigen::Index>(i)).cast<double>() - origin;
        if (d.norm() > kFarthest) return kNone;
        sum += d;
        squares += d * d.transpose();
    }
    const Eigen::Vector3d mean = sum / kNeighbours;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pca(
        Eigen::Matrix3d(squares / kNeighbours - mean * mean.transpose()));
    const Eigen::Vector3d& variances = pca.eigenvalues();
    if (variances[0] > kFlatness * variances[1] || variances[1] < kBreadth * variances[2])
        return kNone;
    return std::abs(pca.eigenvectors().col(0).dot(mean));
}

/** Each query against its neighbours in `map` that `belongs(query, neighbour)` lets through. */
template <typename Belongs>
Distances distances(const Eigen::Matrix3Xf& queries, const Eigen::Matrix3Xf& map,
                    const Belongs& belongs) {
    constexpr std::size_t kLookedAt = 3 * kNeighbours;
    const KdTree tree(map);
    Distances result(static_cast<std::size_t>(queries.cols()));
    tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t i) {
        const Eigen::Vector3f query = queries.col(static_cast<Eigen::Index>(i));
        std::uint32_t found[kLookedAt];
        float squared[kLookedAt];
        const std::size_t count = tree.nearest(query, kLookedAt, found, squared);
        std::vector<std::uint32_t> near;
        for (std::size_t k = 0; k < count && near.size() < kNeighbours; ++k)
            if (belongs(i, found[k])) near.push_back(found[k]);
        result[i] = distanceToPlane(query, map, near);
    });
    return result;
}
}  // namespace

MapPoints mapPoints(const std::vector<SplitScan>& scans, const Poses& rough, double spacing) {
    std::vector<Eigen::Matrix3Xf> thinned;
    thinned.reserve(scans.size());
    for (const auto& scan : scans) thinned.push_back(voxelCentroids(scan.used, spacing));
    const MapPoints all = joined(thinned);
    const Eigen::Matrix3Xf there = placed(all, rough);
    const auto numbers = numberVoxels(there, spacing);
    std::vector<Eigen::Index> kept(static_cast<std::size_t>(numbers.voxels), -1);
    for (Eigen::Index i = 0; i < there.cols(); ++i) {
        auto& best = kept[numbers.ofPoint[static_cast<std::size_t>(i)]];
        if (best < 0 ||
            mixed(static_cast<std::uint64_t>(i)) < mixed(static_cast<std::uint64_t>(best)))
            best = i;
    }
    return chosen(all, kept);
}

MapPoints heldOutPoints(const std::vector<SplitScan>& scans, double spacing) {
    std::vector<Eigen::Matrix3Xf> thinned;
    thinned.reserve(scans.size());
    for (const auto& scan : scans) thinned.push_back(voxelCentroids(scan.heldOut, spacing));
    return joined(thinned);
}

Distances mapThickness(const MapPoints& map, const Poses& poses) {
    const Eigen::Matrix3Xf points = placed(map, poses);
    return distances(points, points,
                     [](std::size_t query, std::uint32_t found) { return query != found; });
}

Distances heldOutResiduals(const MapPoints& map, const MapPoints& queries, const Poses& poses) {
    return distances(placed(queries, poses), placed(map, poses),
                     [&](std::size_t query, std::uint32_t found) {
                         return queries.scan[query] != map.scan[found];
                     });
}
}  // namespace delio
