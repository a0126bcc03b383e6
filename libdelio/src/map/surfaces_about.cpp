#include "surfaces_about.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/principal_axes.h"
#include "core/voxel_table.h"

namespace delio::map {
namespace {
using Voxel = Eigen::Array3i;

/** The first point of each voxel, found by its place. */
class FirstPoints {
 public:
    FirstPoints(const MapPoints& points, double size) : size_(size) {
        firsts_.reserve(points.size());
        index_.reserve(points.size());
        for (std::uint32_t i = 0; i < points.size(); ++i)
            if (index_.insert(keyOf(voxelOf(points[i]))) == firsts_.size()) firsts_.push_back(i);
    }

    Voxel voxelOf(const MapPoint& point) const {
        return (point.position.cast<double>().array() / size_).floor().cast<int>();
    }

    template <typename Visit>
    void forNeighbours(const Voxel& voxel, const Visit& visit) const {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const auto number = index_.find(keyOf(voxel + Voxel(x, y, z)));
                    if (number != VoxelIndex::kNone) visit(firsts_[number]);
                }
    }

 private:
    static std::uint64_t keyOf(const Voxel& voxel) {
        const auto part = [](int v) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & ((1U << 21) - 1);
        };
        return part(voxel.x()) << 42 | part(voxel.y()) << 21 | part(voxel.z());
    }

    double size_;
    VoxelIndex index_;
    std::vector<std::uint32_t> firsts_;
};
}  // namespace

void findSurfaces(MapPoints& points, double spacing) {
    constexpr double kSpacing_m = 0.2;
    constexpr int kLeast = 5;
    // Points about a line, a pole or a single ring, have no normal.
    constexpr double kBroad = 0.05;
    const FirstPoints firsts(points, spacing > 0 ? spacing : kSpacing_m);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        MapPoint& point = points[i];
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
        int count = 0;
        firsts.forNeighbours(firsts.voxelOf(point), [&](std::uint32_t other) {
            const Eigen::Vector3f d = points[other].position - point.position;
            sum += d;
            squares += d * d.transpose();
            ++count;
        });
        const Eigen::Vector3f towards = point.normal;
        point.normal.setZero();
        if (count < kLeast) return;
        const Eigen::Vector3f mean = sum / static_cast<float>(count);
        const Eigen::Matrix3f scatter =
            squares / static_cast<float>(count) - mean * mean.transpose();
        const auto [variances, axes] = principalAxes(scatter.cast<double>());
        if (!(variances[1] > kBroad * variances[2])) return;
        point.residual_m = static_cast<float>(std::sqrt(std::max(variances[0], 0.0)));
        point.normal = axes.col(0).cast<float>();
        if (point.normal.dot(towards) < 0) point.normal = -point.normal;
    });
}
}  // namespace delio::map
