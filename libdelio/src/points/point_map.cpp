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

/** Of the cell, where it is nearer than `least` (squared metres). */
bool PointMap::Cell::nearest(const Eigen::Vector3d& point, float& least,
                             Eigen::Vector3d& found) const {
    const Eigen::Vector3f local = (point - origin).cast<float>();
    std::size_t best = kMost;
    for (std::size_t i = 0; i < count; ++i) {
        const float squared = (points[i] - local).squaredNorm();
        if (squared >= least) continue;
        least = squared;
        best = i;
    }
    if (best == kMost) return false;
    found = origin + points[best].cast<double>();
    return true;
}

bool PointMap::nearest(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& found) const {
    const double size = options_.voxel_size;
    const Eigen::Vector3d inVoxels = point / size, own = inVoxels.array().floor();
    // How far the voxels before, at and behind the point's own are, along each axis.
    const Eigen::Array3d before = size * (inVoxels - own).array();
    Eigen::Array33d distances;
    distances << before, Eigen::Array3d::Zero(), size - before;
    const Eigen::Array33d squares = distances.square();
    auto least = static_cast<float>(std::min(reach * reach, size * size));
    bool any = false;
    for (const int x : {1, 0, 2})  // its own first: what is nearer leaves out most others
        for (const int y : {1, 0, 2})
            for (const int z : {1, 0, 2}) {
                if (squares(0, x) + squares(1, y) + squares(2, z) >= least) continue;
                const Eigen::Vector3d middle = own + Eigen::Vector3d(x - 0.5, y - 0.5, z - 0.5);
                const auto cell = cells_.find(scan::voxelKey(middle, 1));
                if (cell != cells_.end()) any |= cell->second.nearest(point, least, found);
            }
    return any;
}
}  // namespace delio::points
