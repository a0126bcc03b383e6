#include "delio/points/point_map.h"

#include <algorithm>
#include <array>

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
        Cell& cell = cells_[cells_.insert(scan::voxelKey(point, options_.voxel_size))];
        if (cell.count == Cell::kMost) continue;
        if (cell.count == 0) cell.origin = point;
        const Eigen::Vector3f local = (point - cell.origin).cast<float>();
        bool isNew = true;
        for (Eigen::Index first = 0; isNew && first < cell.count; first += Cell::kTogether)
            isNew = cell.distances(first, local).minCoeff() >= squaredSpacing;
        if (!isNew) continue;
        cell.points.row(cell.count++) = local.array();
        ++size_;
    }
}

void PointMap::erase(const Eigen::Matrix3Xd& points) {
    const auto squaredSpacing = static_cast<float>(options_.spacing * options_.spacing);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i);
        Cell* cell = cells_.find(scan::voxelKey(point, options_.voxel_size));
        if (!cell) continue;
        const auto local = (point - cell->origin).cast<float>().transpose().array().eval();
        Eigen::Index kept = 0;
        for (Eigen::Index row = 0; row < cell->count; ++row) {
            if ((cell->points.row(row) - local).square().sum() < squaredSpacing) continue;
            const Eigen::Array<float, 1, 3> stays = cell->points.row(row);
            cell->points.row(kept++) = stays;
        }
        cell->points.middleRows(kept, cell->count - kept)
            .setConstant(std::numeric_limits<float>::infinity());
        size_ -= static_cast<std::size_t>(cell->count - kept);
        cell->count = kept;
    }
}

void PointMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    cells_.eraseIf(
        [&](const Cell& cell) { return (cell.origin - centre).norm() > options_.radius; });
    size_ = 0;
    for (const Cell& cell : cells_) size_ += static_cast<std::size_t>(cell.count);
}

void PointMap::clear() {
    cells_.clear();
    size_ = 0;
}

/** Of the cell, where it is nearer than `least` (squared metres). */
bool PointMap::Cell::nearest(const Eigen::Vector3d& point, float& least,
                             Eigen::Vector3d& found) const {
    const Eigen::Vector3f local = (point - origin).cast<float>();
    Eigen::Index best = kMost;
    for (Eigen::Index first = 0; first < count; first += kTogether) {
        const Distances squared = distances(first, local);
        const float lowest = squared.minCoeff();
        if (!(lowest < least)) continue;
        least = lowest;
        best = first;
        while (squared[best - first] != lowest) ++best;
    }
    if (best == kMost) return false;
    found = origin + points.row(best).matrix().transpose().cast<double>();
    return true;
}

bool PointMap::nearest(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& found) const {
    const double size = options_.voxel_size;
    // How far, squared, the voxels at, before and behind the point's own are, along each axis: its
    // own first, as what is found there leaves out most others.
    std::array<std::int64_t, 3> own;
    std::array<std::array<double, 3>, 3> squares;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double inVoxels = point[static_cast<Eigen::Index>(axis)] / size;
        own[axis] = scan::floorOf(inVoxels);
        const double before = size * (inVoxels - static_cast<double>(own[axis])),
                     behind = size - before;
        squares[axis] = {0, before * before, behind * behind};
    }
    constexpr std::array<std::int64_t, 3> kOffsets = {0, -1, 1};
    auto least = static_cast<float>(std::min(reach * reach, size * size));
    bool any = false;
    for (std::size_t x = 0; x < 3; ++x)
        for (std::size_t y = 0; y < 3; ++y) {
            const double flat = squares[0][x] + squares[1][y];
            if (flat >= double{least}) continue;
            for (std::size_t z = 0; z < 3; ++z) {
                if (flat + squares[2][z] >= double{least}) continue;
                const Cell* cell = cells_.find(scan::voxelKey(
                    own[0] + kOffsets[x], own[1] + kOffsets[y], own[2] + kOffsets[z]));
                if (cell) any |= cell->nearest(point, least, found);
            }
        }
    return any;
}
}  // namespace delio::points
