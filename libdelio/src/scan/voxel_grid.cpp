#include "delio/scan/voxel_grid.h"

#include <tbb/parallel_for.h>

#include "delio/scan/voxel_table.h"

namespace delio::scan {
std::uint64_t voxelKey(const Eigen::Vector3d& point, double size) {
    return voxelKey(floorOf(point.x() / size), floorOf(point.y() / size),
                    floorOf(point.z() / size));
}

VoxelNumbers numberVoxels(const Eigen::Matrix3Xf& points, double size) {
    std::vector<std::uint64_t> keys(static_cast<std::size_t>(points.cols()));
    tbb::parallel_for(Eigen::Index{0}, points.cols(), [&](Eigen::Index i) {
        keys[static_cast<std::size_t>(i)] = voxelKey(points.col(i).cast<double>(), size);
    });
    VoxelIndex numbers;
    constexpr std::size_t kTypical = 4;  // points a voxel
    numbers.reserve(static_cast<std::size_t>(points.cols()) / kTypical);
    VoxelNumbers result;
    result.ofPoint.reserve(static_cast<std::size_t>(points.cols()));
    // Most points lie in the voxel of the one before: a sensor gives neighbours after each other.
    constexpr std::size_t kAhead = 16;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i + kAhead < keys.size()) numbers.prefetch(keys[i + kAhead]);
        const bool isSame = i > 0 && keys[i] == keys[i - 1];
        result.ofPoint.push_back(isSame ? result.ofPoint.back() : numbers.insert(keys[i]));
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

Eigen::Matrix3Xf firstOfVoxels(const Eigen::Matrix3Xf& points, double size) {
    const auto numbers = numberVoxels(points, size);
    Eigen::Matrix3Xf first(3, numbers.voxels);
    Eigen::Index met = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (numbers.ofPoint[static_cast<std::size_t>(i)] == met) first.col(met++) = points.col(i);
    return first;
}
}  // namespace delio::scan
