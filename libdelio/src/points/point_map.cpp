#include "delio/points/point_map.h"

#include <algorithm>
#include <iterator>

#include "delio/scan/voxel_grid.h"

namespace delio::points {
std::vector<OptionField> PointMapOptions::fields() const {
    using Me = PointMapOptions;
    return {{"voxel_size", &Me::voxel_size,
             "m; edge of the voxels, and the farthest that a pair is apart", 0.05, 20},
            {"spacing", &Me::spacing, "m; points of one voxel are at least so far apart", 0.01, 10},
            {"radius", &Me::radius, "m; the map ends at this distance from the sensor", 1, 1e4}};
}

void PointMap::add(const Eigen::Matrix3Xd& points) {
    const auto squaredSpacing = static_cast<float>(options_.spacing * options_.spacing);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i);
        Cell& cell = cells_[scan::voxelKey(point, options_.voxel_size)];
        if (cell.count == Cell::kMost) continue;
        if (cell.count == 0) cell.origin = point;
        const Eigen::Vector3f local = (point - cell.origin).cast<float>();
        const auto end = cell.points.begin() + static_cast<std::ptrdiff_t>(cell.count);
        const bool isNew = std::none_of(cell.points.begin(), end, [&](const Eigen::Vector3f& p) {
            return (p - local).squaredNorm() < squaredSpacing;
        });
        if (!isNew) continue;
        cell.points[cell.count++] = local;
        ++size_;
    }
}

void PointMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    for (auto i = cells_.begin(); i != cells_.end();) {
        const bool isFar = (i->second.origin - centre).norm() > options_.radius;
        if (isFar) size_ -= i->second.count;
        i = isFar ? cells_.erase(i) : std::next(i);
    }
}

void PointMap::clear() {
    cells_.clear();
    size_ = 0;
}

bool PointMap::nearest(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& found) const {
    const double size = options_.voxel_size, step = std::min(reach, size);
    const Eigen::Vector3d low = ((point.array() - step) / size).floor(),
                          high = ((point.array() + step) / size).floor();
    auto least = static_cast<float>(reach * reach);
    bool any = false;
    for (double x = low.x(); x <= high.x(); ++x)
        for (double y = low.y(); y <= high.y(); ++y)
            for (double z = low.z(); z <= high.z(); ++z) {
                const Eigen::Vector3d middle(x + 0.5, y + 0.5, z + 0.5);
                const auto cell = cells_.find(scan::voxelKey(size * middle, size));
                if (cell == cells_.end()) continue;
                const Cell& near = cell->second;
                const Eigen::Vector3f local = (point - near.origin).cast<float>();
                for (std::size_t i = 0; i < near.count; ++i) {
                    const float squared = (near.points[i] - local).squaredNorm();
                    if (squared >= least) continue;
                    least = squared;
                    found = near.origin + near.points[i].cast<double>();
                    any = true;
                }
            }
    return any;
}
}  // namespace delio::points
