#include "odometry/point_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/voxel_grid.h"
#include "core/voxel_table.h"

namespace delio::odometry {
Eigen::Vector3f PointMap::Cell::point(std::uint32_t number) const {
    const Group& group = groups[number / Group::kSize];
    const Eigen::Index i = number % Group::kSize;
    return {group.x[i], group.y[i], group.z[i]};
}

void PointMap::Cell::set(std::uint32_t number, const Eigen::Vector3f& point) {
    Group& group = groups[number / Group::kSize];
    const Eigen::Index i = number % Group::kSize;
    group.x[i] = point.x();
    group.y[i] = point.y();
    group.z[i] = point.z();
}

/** False where it is full, or has one that is too near. */
bool PointMap::Cell::add(const Eigen::Vector3d& point, float squaredSpacing) {
    if (count == kMost) return false;
    if (count == 0) origin = point;
    const Eigen::Vector3f local = (point - origin).cast<float>();
    const bool isNew =
        std::all_of(groups.begin(), groups.begin() + groupsTaken(), [&](const Group& group) {
            return group.squaredDistances(local).minCoeff() >= squaredSpacing;
        });
    if (isNew) set(count++, local);
    return isNew;
}

void PointMap::add(const Eigen::Matrix3Xd& points) {
    const auto squaredSpacing = static_cast<float>(options_.spacing * options_.spacing);
    std::vector<std::uint64_t> voxels(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        voxels[static_cast<std::size_t>(i)] = voxelKey(points.col(i), options_.voxel_size);
    cells_.forEach(cells_.insert(voxels), [&](std::size_t i, Cell& cell) {
        size_ += cell.add(points.col(static_cast<Eigen::Index>(i)), squaredSpacing);
    });
}

void PointMap::erase(const Eigen::Matrix3Xd& points) {
    const auto squaredSpacing = static_cast<float>(options_.spacing * options_.spacing);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d point = points.col(i);
        Cell* cell = cells_.find(voxelKey(point, options_.voxel_size));
        if (!cell) continue;
        const Eigen::Vector3f local = (point - cell->origin).cast<float>();
        std::uint32_t kept = 0;
        for (std::uint32_t k = 0; k < cell->count; ++k) {
            const Eigen::Vector3f other = cell->point(k);
            if ((other - local).squaredNorm() >= squaredSpacing) cell->set(kept++, other);
        }
        constexpr float kNowhere = std::numeric_limits<float>::infinity();
        for (std::uint32_t k = kept; k < cell->count; ++k)
            cell->set(k, Eigen::Vector3f::Constant(kNowhere));
        size_ -= cell->count - kept;
        cell->count = kept;
    }
}

void PointMap::forgetFarFrom(const Eigen::Vector3d& centre) {
    const VoxelBall near(centre, options_.radius, options_.voxel_size);
    const auto isFar = [&](std::uint64_t voxel, const Cell& cell) {
        const bool far = !near.holds(voxel) && (cell.origin - centre).norm() > options_.radius;
        if (far) size_ -= cell.count;
        return far;
    };
    cells_.eraseIf(isFar, [](std::uint32_t, std::uint32_t) {});
}

void PointMap::clear() {
    cells_.clear();
    size_ = 0;
}

/** A cell that may hold a point's nearest one. */
struct PointMap::Other {
    std::uint64_t voxel = 0;
    double away = 0;  //!< how far it is from the point: squared metres
};

/** What was found of a point so far. */
struct PointMap::Search {
    Search(const Eigen::Vector3d& point, double size, double reach);
    std::uint64_t ownVoxel() const { return voxelKey(own[0], own[1], own[2]); }
    void addOthers(std::vector<Other>& cells);

    /** How far the nearest point and all others are, at least: squared metres. */
    float least = 0, others = 0;
    double passedOver = 0;  //!< the same of the cells that were not searched
    bool any = false;
    Eigen::Vector3d found = Eigen::Vector3d::Zero();
    /** Of the point's own voxel, and how far, squared, the voxels at, before and behind it are
     *  along each axis. */
    std::array<std::int64_t, 3> own{};
    std::array<std::array<double, 3>, 3> squares{};
    std::uint32_t cell = VoxelIndex::kNone;  //!< its own
    std::size_t end = 0;                     //!< of the others: those of this point lie before it
};

PointMap::Search::Search(const Eigen::Vector3d& point, double size, double reach)
    : least(static_cast<float>(std::min(reach * reach, size * size))),
      others(least),
      passedOver(least) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double inVoxels = point[static_cast<Eigen::Index>(axis)] / size;
        own[axis] = floorOf(inVoxels);
        const double before = size * (inVoxels - static_cast<double>(own[axis])),
                     behind = size - before;
        squares[axis] = {0, before * before, behind * behind};
    }
}

/** Once its own cell was searched. */
void PointMap::Search::addOthers(std::vector<Other>& cells) {
    constexpr std::array<std::int64_t, 3> kOffsets = {0, -1, 1};
    for (std::size_t x = 0; x < 3; ++x)
        for (std::size_t y = 0; y < 3; ++y) {
            const double flat = squares[0][x] + squares[1][y];
            if (flat >= double{least}) {
                passedOver = std::min(passedOver, flat);
                continue;
            }
            for (std::size_t z = 0; z < 3; ++z) {
                const double away = flat + squares[2][z];
                if (away >= double{least})
                    passedOver = std::min(passedOver, away);
                else if (x + y + z > 0)
                    cells.push_back(
                        {voxelKey(own[0] + kOffsets[x], own[1] + kOffsets[y], own[2] + kOffsets[z]),
                         away});
            }
        }
    end = cells.size();
}

/** Of the cell, where it is nearer than what was found before. */
void PointMap::Cell::nearest(const Eigen::Vector3d& point, Search& search) const {
    const Eigen::Vector3f local = (point - origin).cast<float>();
    std::uint32_t best = kMost;
    for (Eigen::Index g = 0; g < groupsTaken(); ++g) {
        auto squared = groups[static_cast<std::size_t>(g)].squaredDistances(local).eval();
        const float lowest = squared.minCoeff();
        if (!(lowest < search.least)) {
            search.others = std::min(search.others, lowest);
            continue;
        }
        std::uint32_t in = 0;
        while (squared[in] != lowest) ++in;
        squared[in] = std::exchange(search.least, lowest);
        search.others = std::min(search.others, squared.minCoeff());
        best = static_cast<std::uint32_t>(g * Group::kSize) + in;
    }
    if (best == kMost) return;
    search.any = true;
    search.found = origin + this->point(best).cast<double>();
}

/** Each step is done for all points before the next one, and prefetches what that needs. */
void PointMap::findInBlock(const Eigen::Ref<const Eigen::Matrix3Xd>& points, double reach,
                           Nearest* found) const {
    constexpr std::size_t kTypical = 4;
    const auto count = static_cast<std::size_t>(points.cols());
    std::vector<Search> searches;
    searches.reserve(count);
    std::vector<Other> others;
    others.reserve(kTypical * count);
    const auto firstOf = [&](std::size_t i) { return i == 0 ? 0 : searches[i - 1].end; };
    const auto pointOf = [&](std::size_t i) -> Eigen::Vector3d {
        return points.col(static_cast<Eigen::Index>(i));
    };
    for (std::size_t i = 0; i < count; ++i) {
        searches.emplace_back(pointOf(i), options_.voxel_size, reach);
        cells_.prefetch(searches.back().ownVoxel());
    }
    for (std::size_t i = 0; i < count; ++i) {
        searches[i].cell = cells_.numberOf(searches[i].ownVoxel());
        if (searches[i].cell != VoxelIndex::kNone) cells_.prefetchValue(searches[i].cell);
    }
    for (std::size_t i = 0; i < count; ++i) {
        Search& search = searches[i];
        if (search.cell != VoxelIndex::kNone) cells_[search.cell].nearest(pointOf(i), search);
        search.addOthers(others);
        if (!search.any) continue;  // the first of the others leave out most
        for (std::size_t k = firstOf(i); k < search.end; ++k) cells_.prefetch(others[k].voxel);
    }
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = firstOf(i); searches[i].any && k < searches[i].end; ++k) {
            const std::uint32_t cell = cells_.numberOf(others[k].voxel);
            if (cell != VoxelIndex::kNone) cells_.prefetchValue(cell);
        }
    for (std::size_t i = 0; i < count; ++i) {
        Search& search = searches[i];
        for (std::size_t k = firstOf(i); k < search.end; ++k) {
            if (others[k].away >= double{search.least})
                search.passedOver = std::min(search.passedOver, others[k].away);
            else if (const Cell* cell = cells_.find(others[k].voxel))
                cell->nearest(pointOf(i), search);
        }
        found[i] = {search.any, search.found,
                    std::sqrt(std::min(search.passedOver, double{search.others}))};
    }
}

std::vector<PointMap::Nearest> PointMap::nearestOf(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                                   double reach) const {
    std::vector<Nearest> found(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index first = 0; first < points.cols(); first += kBlock)
        findInBlock(points.middleCols(first, std::min(kBlock, points.cols() - first)), reach,
                    found.data() + first);
    return found;
}
}  // namespace delio::odometry
