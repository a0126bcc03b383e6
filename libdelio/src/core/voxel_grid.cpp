#include "core/voxel_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>

#include "core/voxel_table.h"

namespace delio {
namespace {
constexpr Eigen::Index kBlock = 512;  // points that findKeys() takes at most

void findKeys(const float* points, Eigen::Index count, float perVoxel, std::uint64_t* keys) {
    // All coordinates alike, and in a plain loop: vector instructions.
    constexpr float kFarthest = 1 << 20;  // what keys have room for
    std::array<std::int32_t, 3 * kBlock> voxels;
    for (Eigen::Index i = 0; i < 3 * count; ++i) {
        const float inVoxels = std::clamp(points[i] * perVoxel, -kFarthest, kFarthest - 1);
        const auto truncated = static_cast<std::int32_t>(inVoxels);
        voxels[static_cast<std::size_t>(i)] =
            truncated - (inVoxels < static_cast<float>(truncated) ? 1 : 0);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
        keys[i] = voxelKey(voxels[3 * i], voxels[3 * i + 1], voxels[3 * i + 2]);
}
}  // namespace

VoxelNumbers numberVoxels(const Eigen::Matrix3Xf& points, double size) {
    const auto count = static_cast<std::size_t>(points.cols());
    std::vector<std::uint64_t> keys(count);
    using Range = tbb::blocked_range<Eigen::Index>;
    tbb::parallel_for(Range(0, points.cols(), kBlock), [&](const Range& range) {
        for (Eigen::Index first = range.begin(); first < range.end(); first += kBlock)
            findKeys(points.data() + 3 * first, std::min(kBlock, range.end() - first),
                     static_cast<float>(1 / size), keys.data() + first);
    });
    VoxelIndex numbers;
    constexpr std::size_t kTypical = 2;  // points a voxel
    numbers.reserve(count / kTypical);
    VoxelNumbers result;
    result.ofPoint.resize(count);
    // (Most points lie in the voxel of the one before, but to ask for that is a guess for many of
    // them, and costs more than to look it up.)
    constexpr std::size_t kAhead = 16;
    for (std::size_t i = 0; i < count; ++i) {
        if (i + kAhead < count) numbers.prefetch(keys[i + kAhead]);
        result.ofPoint[i] = numbers.insert(keys[i]);
    }
    result.voxels = static_cast<Eigen::Index>(numbers.size());
    return result;
}

Eigen::Matrix3Xf centroidsOf(const Eigen::Matrix3Xf& points, const VoxelNumbers& numbers) {
    Eigen::Matrix3Xf centroids = Eigen::Matrix3Xf::Zero(3, numbers.voxels);
    Eigen::RowVectorXf counts = Eigen::RowVectorXf::Zero(numbers.voxels);
    // Points of one voxel that come after each other are summed up before they are put down.
    for (Eigen::Index i = 0; i < points.cols();) {
        const Eigen::Index voxel = numbers.ofPoint[static_cast<std::size_t>(i)];
        Eigen::Vector3f sum = centroids.col(voxel);
        float count = counts[voxel];
        do {
            sum += points.col(i);
            count += 1;
        } while (++i < points.cols() && numbers.ofPoint[static_cast<std::size_t>(i)] == voxel);
        centroids.col(voxel) = sum;
        counts[voxel] = count;
    }
    centroids.array().rowwise() /= counts.array();
    return centroids;
}

Eigen::Matrix3Xf voxelCentroids(const Eigen::Matrix3Xf& points, double size) {
    return centroidsOf(points, numberVoxels(points, size));
}

std::vector<Eigen::Index> firstsOf(const VoxelNumbers& numbers) {
    std::vector<Eigen::Index> firsts(static_cast<std::size_t>(numbers.voxels));
    // The first one overwrites the others: no branches.
    for (std::size_t i = numbers.ofPoint.size(); i-- > 0;)
        firsts[numbers.ofPoint[i]] = static_cast<Eigen::Index>(i);
    return firsts;
}

std::vector<Eigen::Index> firstsOfVoxels(const Eigen::Matrix3Xf& points, double size) {
    return firstsOf(numberVoxels(points, size));
}

Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size) {
    return points(Eigen::all, firstsOfVoxels(points, size));
}

Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size, double smallest,
                               Eigen::Index enough) {
    auto kept = firstOfVoxels(points, size);
    while (kept.cols() < enough && size > smallest)
        kept = firstOfVoxels(points, size = std::max(size / 2, smallest));
    return kept;
}
}  // namespace delio
