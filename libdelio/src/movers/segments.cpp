#include "delio/movers/segments.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace delio::movers {
namespace {
/** Square cells on the ground plane about the origin. */
class Grid {
 public:
    Grid(double cell, double radius)
        : cell_(static_cast<float>(cell)),
          half_(static_cast<int>(std::ceil(radius / cell))),
          width_(2 * half_ + 1) {}

    std::size_t size() const { return cells(width_) * cells(width_); }
    /** The cell's number, or size() outside. */
    std::size_t at(float x, float y) const {
        const int i = static_cast<int>(std::lround(x / cell_)) + half_;
        const int j = static_cast<int>(std::lround(y / cell_)) + half_;
        return inside(i, j) ? number(i, j) : size();
    }
    template <typename Visit>
    void forNeighbours(std::size_t cell, const Visit& visit) const {
        const int i = static_cast<int>(cell) / width_, j = static_cast<int>(cell) % width_;
        for (int a = i - 1; a <= i + 1; ++a)
            for (int b = j - 1; b <= j + 1; ++b)
                if (inside(a, b)) visit(number(a, b));
    }

 private:
    bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < width_ && j < width_; }
    static std::size_t cells(int count) { return static_cast<std::size_t>(count); }
    std::size_t number(int i, int j) const { return cells(i) * cells(width_) + cells(j); }

    float cell_;
    int half_, width_;
};

/** Height of each point above the lowest ones in its cell of a metre and those about it. */
std::vector<float> heights(const Eigen::Matrix3Xf& points, double radius) {
    constexpr float kNone = std::numeric_limits<float>::max();
    const Grid grid(1, radius);
    std::vector<float> lowest(grid.size() + 1, kNone), about = lowest;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        float& low = lowest[grid.at(points(0, i), points(1, i))];
        low = std::min(low, points(2, i));
    }
    for (std::size_t cell = 0; cell < grid.size(); ++cell)
        if (lowest[cell] != kNone)
            grid.forNeighbours(cell, [&](std::size_t neighbour) {
                about[cell] = std::min(about[cell], lowest[neighbour]);
            });
    std::vector<float> result(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        result[static_cast<std::size_t>(i)] =
            points(2, i) - about[grid.at(points(0, i), points(1, i))];
    return result;
}

constexpr std::int32_t kNone = -1;

/** The points that stand above the ground, cell by cell: from each to the next one of its cell. (A
 *  list a cell would be tens of thousands of allocations a scan.) */
struct Chains {
    std::vector<std::int32_t> first, next;
    std::vector<std::size_t> filled;  //!< cells, in the order of their first points
};

Chains chainsOf(const Eigen::Matrix3Xf& points, const std::vector<float>& above, const Grid& grid,
                const SegmentOptions& options) {
    Chains chains{std::vector<std::int32_t>(grid.size(), kNone),
                  std::vector<std::int32_t>(above.size(), kNone),
                  {}};
    std::vector<std::int32_t> last(grid.size(), kNone);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto height = double{above[static_cast<std::size_t>(i)]};
        if (height < options.above_ground || height > options.height) continue;
        const std::size_t cell = grid.at(points(0, i), points(1, i));
        if (cell == grid.size()) continue;
        const auto point = static_cast<std::int32_t>(i);
        if (last[cell] == kNone) {
            chains.filled.push_back(cell);
            chains.first[cell] = point;
        } else {
            chains.next[static_cast<std::size_t>(last[cell])] = point;
        }
        last[cell] = point;
    }
    return chains;
}
}  // namespace

std::vector<OptionField> SegmentOptions::fields() const {
    return {
        {"cell", &SegmentOptions::cell, "m; points of cells that touch belong together", 0.1, 10},
        {"radius", &SegmentOptions::radius, "m; farther from the sensor nothing is looked for", 1,
         100},
        {"above_ground", &SegmentOptions::above_ground, "m; what is lower is ground", 0, 10},
        {"height", &SegmentOptions::height, "m; what is higher is no road user", 0.1, 20},
        {"max_length", &SegmentOptions::max_length, "m; what is longer is no road user", 0.1, 100},
        {"min_points", &SegmentOptions::min_points, "points that a road user has at least", 1,
         1e6}};
}

std::vector<Segment> segmentsOf(const Eigen::Matrix3Xf& points, const SegmentOptions& options) {
    const auto above = heights(points, options.radius);
    const Grid grid(options.cell, options.radius);
    const Chains cells = chainsOf(points, above, grid, options);
    std::vector<std::uint8_t> taken(grid.size());
    std::vector<Segment> segments;
    for (const std::size_t start : cells.filled) {
        if (taken[start]) continue;
        Segment segment;
        std::vector<std::size_t> open = {start};
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            if (taken[cell]) continue;
            taken[cell] = true;
            for (Eigen::Index i = cells.first[cell]; i != kNone;
                 i = cells.next[static_cast<std::size_t>(i)]) {
                segment.points.push_back(i);
                segment.box.extend(points.col(i));
            }
            grid.forNeighbours(cell, [&](std::size_t neighbour) {
                if (!taken[neighbour] && cells.first[neighbour] != kNone) open.push_back(neighbour);
            });
        }
        const auto length = double{segment.box.sizes().head<2>().maxCoeff()};
        if (segment.points.size() >= options.min_points && length <= options.max_length)
            segments.push_back(std::move(segment));
    }
    return segments;
}
}  // namespace delio::movers
