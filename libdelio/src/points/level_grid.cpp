#include "level_grid.h"

#include <tbb/parallel_for.h>

#include <array>
#include <vector>

#include "delio/scan/voxel_grid.h"

namespace delio::points {
namespace {
Eigen::Array3i cellOf(const Eigen::Vector3d& inCells) {
    return inCells.array().unaryExpr([](double x) { return static_cast<int>(scan::floorOf(x)); });
}

/** Cells of half a step, so that a step is two of them: what is asked for from one row of places
 * are every second one's bits. So those of even numbers lie side by side, and those of odd ones. */
class Grid {
 public:
    using Cell = Eigen::Array3i;

    /** False of what is so far away that little would be seen there. */
    static bool holds(const Cell& cell) {
        constexpr int kFar = 300;
        return cell.z() > -kBelow && cell.z() < kLevels - kBelow - 1 &&
               (cell.head<2>().abs() <= kFar).all();
    }

    /** For cells from `low` to `high`, and from all places about them. */
    Grid(const Eigen::Array2i& low, const Eigen::Array2i& high, int steps)
        : steps_(steps), first_(low - 2 * steps - 1), size_(high + 2 * steps + 2 - first_) {
        for (auto& words : kinds_) words.setZero((size_.x() + 1) / 2, (size_.y() + 1) / 2);
    }

    /** And those that share a side with it. */
    void mark(const Cell& cell) {
        constexpr std::uint64_t kOne = 1, kThreeOnes = 7;
        const Eigen::Array2i at = cell.head<2>() - first_;
        const int bit = cell.z() + kBelow;
        if ((at < 1 || at > size_ - 2).any() || bit < 1 || bit > kLevels - 2) return;
        word(at.x(), at.y()) |= kThreeOnes << (bit - 1);
        for (const int aside : {-1, 1}) {
            word(at.x() + aside, at.y()) |= kOne << bit;
            word(at.x(), at.y() + aside) |= kOne << bit;
        }
    }

    /** Adds, for all places of a row, whether the cell is marked as seen from there. */
    void count(const Cell& cell, int y, Eigen::Ref<Eigen::Array<std::uint64_t, -1, 1>> row) const {
        const Eigen::Array2i at = cell.head<2>() - first_ - 2 * steps_ + Eigen::Array2i(0, 2 * y);
        const int bit = cell.z() + kBelow;
        row += kinds_[kindOf(at.x(), at.y())]
                   .col(at.y() / 2)
                   .segment(at.x() / 2, row.size())
                   .unaryExpr([bit](std::uint64_t word) { return word >> bit & 1; });
    }

 private:
    static constexpr int kLevels = 64, kBelow = 16;
    static std::size_t kindOf(int x, int y) {
        return 2 * static_cast<std::size_t>(y & 1) + static_cast<std::size_t>(x & 1);
    }
    std::uint64_t& word(int x, int y) { return kinds_[kindOf(x, y)](x / 2, y / 2); }

    const int steps_;
    const Eigen::Array2i first_, size_;
    std::array<LevelCounts, 4> kinds_;  //!< a column of cells each, with a bit a level
};
}  // namespace

LevelCounts countsFrom(const LevelSquare& square, const PointMap& map,
                       const Eigen::Matrix3Xd& points) {
    const Eigen::Matrix3d inCells = 2 / square.step * square.upright.cast<double>();
    std::vector<Grid::Cell> cells;
    Eigen::Array2i low = Eigen::Array2i::Zero(), high = low;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Grid::Cell cell = cellOf(inCells * points.col(i));
        if (!Grid::holds(cell)) continue;
        low = low.min(cell.head<2>());
        high = high.max(cell.head<2>());
        cells.push_back(cell);
    }
    Grid grid(low, high, square.steps);
    const Eigen::Isometry3d toSensor = square.middle.inverse();
    const Eigen::Matrix3d turn = inCells * toSensor.linear();
    const Eigen::Vector3d shift = inCells * toSensor.translation();
    map.forEachPoint(
        [&](const Eigen::Vector3d& point) { grid.mark(cellOf(turn * point + shift)); });
    LevelCounts counts = LevelCounts::Zero(square.side(), square.side());
    tbb::parallel_for(0, square.side(), [&](int y) {
        for (const auto& cell : cells) grid.count(cell, y, counts.col(y));
    });
    return counts;
}
}  // namespace delio::points
