#include "delio/scan/voxel_grid.h"

#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace delio::scan {
std::uint64_t voxelKey(const Eigen::Vector3d& point, double size) {
    constexpr std::int64_t kHalf = 1 << 20;  // 21 bits for each axis
    const auto part = [&](double value) {
        const double voxels = value / size;
        auto index = static_cast<std::int64_t>(voxels);
        index -= voxels < static_cast<double>(index);  // rounded down: std::floor is a call
        return static_cast<std::uint64_t>(index + kHalf) & (2 * kHalf - 1);
    };
    return part(point.x()) << 42 | part(point.y()) << 21 | part(point.z());
}

VoxelNumbers numberVoxels(const Eigen::Matrix3Xf& points, double size) {
    std::unordered_map<std::uint64_t, Eigen::Index> numbers;
    numbers.reserve(static_cast<std::size_t>(points.cols()));
    VoxelNumbers result;
    result.ofPoint.reserve(static_cast<std::size_t>(points.cols()));
    // Most points lie in the voxel of the one before: a sensor gives neighbours after each other.
    std::uint64_t latestKey = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const std::uint64_t key = voxelKey(points.col(i).cast<double>(), size);
        if (i > 0 && key == latestKey) {
            result.ofPoint.push_back(result.ofPoint.back());
            continue;
        }
        const auto [entry, isNew] = numbers.emplace(key, result.voxels);
        result.voxels += isNew;
        result.ofPoint.push_back(entry->second);
        latestKey = key;
    }
    return result;
}

Eigen::Matrix3Xf centroidsOf(const Eigen::Matrix3Xf& points, const VoxelNumbers& numbers) {
    auto [centroids, counts] = sumsOf<3>(points, numbers);
    centroids.array().rowwise() /= counts.array();
    return centroids;
}

Eigen::Matrix3Xf voxelCentroids(const Eigen::Matrix3Xf& points, double size) {
    return centroidsOf(points, numberVoxels(points, size));
}

Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size) {
    const auto numbers = numberVoxels(points, size);
    Eigen::Matrix3Xf first(3, numbers.voxels);
    Eigen::Index met = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (numbers.ofPoint[static_cast<std::size_t>(i)] == met) first.col(met++) = points.col(i);
    return first;
}
}  // namespace delio::scan
