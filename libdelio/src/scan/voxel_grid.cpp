#include "delio/scan/voxel_grid.h"

#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace delio::scan {
namespace {
/** 21 bits for each axis: a million voxels to either side of the origin. */
std::uint64_t keyOf(const Eigen::Vector3f& p, float scale) {
    const auto part = [&](float value) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value * scale)) +
                                          (1 << 20)) &
               0x1FFFFF;
    };
    return part(p.x()) << 42 | part(p.y()) << 21 | part(p.z());
}
}  // namespace

VoxelNumbers numberVoxels(const Eigen::Matrix3Xf& points, double size) {
    const auto scale = static_cast<float>(1 / size);
    std::unordered_map<std::uint64_t, Eigen::Index> numbers;
    numbers.reserve(static_cast<std::size_t>(points.cols()));
    VoxelNumbers result;
    result.ofPoint.reserve(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto [entry, isNew] = numbers.emplace(keyOf(points.col(i), scale), result.voxels);
        result.voxels += isNew;
        result.ofPoint.push_back(entry->second);
    }
    return result;
}

Eigen::Matrix3Xf voxelCentroids(const Eigen::Matrix3Xf& points, double size) {
    const VoxelNumbers numbers = numberVoxels(points, size);
    Eigen::Matrix3Xf centroids = Eigen::Matrix3Xf::Zero(3, numbers.voxels);
    Eigen::VectorXf counts = Eigen::VectorXf::Zero(numbers.voxels);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Index voxel = numbers.ofPoint[static_cast<std::size_t>(i)];
        centroids.col(voxel) += points.col(i);
        counts[voxel] += 1;
    }
    centroids.array().rowwise() /= counts.transpose().array();
    return centroids;
}
}  // namespace delio::scan
