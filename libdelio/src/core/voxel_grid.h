#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

namespace delio {
/** Key of a voxel from its numbers along the axes, which count from the origin; unique within 2^20
 *  voxels of the origin along each axis. */
inline std::uint64_t voxelKey(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr std::int64_t kHalf = 1 << 20;  // 21 bits for each axis
    const auto part = [](std::int64_t index) {
        return static_cast<std::uint64_t>(index + kHalf) & (2 * kHalf - 1);
    };
    return part(x) << 42 | part(y) << 21 | part(z);
}
/** Key of the voxel, 2^levels times as large, that contains the one of `key`; unique among voxels
 *  of that size. */
inline std::uint64_t coarserKey(std::uint64_t key, unsigned levels) {
    constexpr std::uint64_t kOnes = std::uint64_t{1} << 42 | 1 << 21 | 1;
    return key & ~(kOnes * ((std::uint64_t{1} << levels) - 1));
}
/** Rounded down: without SSE 4.1 std::floor is a call. */
inline std::int64_t floorOf(double value) {
    const auto truncated = static_cast<std::int64_t>(value);
    return truncated - (value < static_cast<double>(truncated));
}
/** Index of the voxel of edge `size` that contains a point. */
inline std::uint64_t voxelKey(const Eigen::Vector3d& point, double size) {
    const Eigen::Vector3d inVoxels = point * (1 / size);
    return voxelKey(floorOf(inVoxels.x()), floorOf(inVoxels.y()), floorOf(inVoxels.z()));
}
/** Which voxel each point is in: voxels are numbered from 0 in the order in which they are first
 *  met. `size` in the unit of the points; also good for directions on the unit sphere. */
struct VoxelNumbers {
    std::vector<std::uint32_t> ofPoint;  //!< of each point the number of its voxel
    Eigen::Index voxels = 0;             //!< how many there are
};
/** See VoxelNumbers. `size`: edge of a voxel. */
VoxelNumbers numberVoxels(const Eigen::Matrix3Xf& points, double size);

/** The sum of the columns in each voxel, and their count. */
template <int kRows>
struct VoxelSums {
    Eigen::Matrix<float, kRows, Eigen::Dynamic> sums;  //!< a voxel a column
    Eigen::RowVectorXf counts;                         //!< of columns in each voxel
};
/** Of columns whose points are numbered so. */
template <int kRows>
VoxelSums<kRows> sumsOf(const Eigen::Matrix<float, kRows, Eigen::Dynamic>& columns,
                        const VoxelNumbers& numbers) {
    VoxelSums<kRows> result;
    result.sums.setZero(kRows, numbers.voxels);
    result.counts.setZero(numbers.voxels);
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
        const Eigen::Index voxel = numbers.ofPoint[static_cast<std::size_t>(i)];
        result.sums.col(voxel) += columns.col(i);
        result.counts[voxel] += 1;
    }
    return result;
}

/** The centroid of the points in each voxel, in the order of their numbers. */
Eigen::Matrix3Xf centroidsOf(const Eigen::Matrix3Xf& points, const VoxelNumbers& numbers);

/** One point per voxel: the centroid of its points, in the order of their numbers. */
Eigen::Matrix3Xf voxelCentroids(const Eigen::Matrix3Xf& points, double size);

/** The column of the first point in each voxel, in the order of their numbers. */
std::vector<Eigen::Index> firstsOf(const VoxelNumbers& numbers);

/** The same of voxels of edge `size`. */
std::vector<Eigen::Index> firstsOfVoxels(const Eigen::Matrix3Xf& points, double size);

/** One point per voxel: the first one. A centroid would lie between a sensor's rings. */
Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size);

/** The same, but the voxels are halved, down to `smallest`, until there are `enough` points: a
 * small room has few surfaces. */
Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size, double smallest,
                               Eigen::Index enough);

/** At most `most` of `count` elements are left if each of this many is kept. */
inline Eigen::Index strideOf(Eigen::Index count, Eigen::Index most) {
    return std::max<Eigen::Index>(1, 1 + (count - 1) / most);
}

/** At most `most` of the columns, evenly over their order: of a scan the same share all around. */
template <typename Columns>
Columns sample(const Columns& columns, Eigen::Index most) {
    const Eigen::Index stride = strideOf(columns.cols(), most);
    Columns result(columns.rows(), (columns.cols() + stride - 1) / stride);
    for (Eigen::Index i = 0; i < result.cols(); ++i) result.col(i) = columns.col(i * stride);
    return result;
}
}  // namespace delio
