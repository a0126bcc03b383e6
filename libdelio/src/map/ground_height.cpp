#include "ground_height.h"

#include <algorithm>
#include <cmath>

namespace delio::map {
namespace {
constexpr double kCell_m = 15;
// Below these lie reflections in wet streets and the like.
constexpr double kLowShare = 0.1;

std::int64_t cellIndex(double v) { return static_cast<std::int64_t>(std::floor(v / kCell_m)); }

std::uint64_t keyOf(std::int64_t column, std::int64_t row) {
    return (static_cast<std::uint64_t>(column) & 0xffffffff) << 32 |
           (static_cast<std::uint64_t>(row) & 0xffffffff);
}
}  // namespace

std::uint64_t GroundHeight::cellOf(double x, double y) { return keyOf(cellIndex(x), cellIndex(y)); }

double GroundHeight::lowOf(std::vector<float>& heights) {
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(
                                           kLowShare * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), low, heights.end());
    return *low;
}

double GroundHeight::ofCell(std::int64_t column, std::int64_t row, double otherwise) const {
    const auto cell = cells_.find(keyOf(column, row));
    return cell == cells_.end() ? otherwise : cell->second;
}

double GroundHeight::at(double x, double y) const {
    const double own = ofCell(cellIndex(x), cellIndex(y), 0);
    // Between the middles of the four nearest cells.
    const double u = x / kCell_m - 0.5, v = y / kCell_m - 0.5;
    const auto column = static_cast<std::int64_t>(std::floor(u));
    const auto row = static_cast<std::int64_t>(std::floor(v));
    const double fu = u - std::floor(u), fv = v - std::floor(v);
    return (1 - fv) * ((1 - fu) * ofCell(column, row, own) + fu * ofCell(column + 1, row, own)) +
           fv * ((1 - fu) * ofCell(column, row + 1, own) + fu * ofCell(column + 1, row + 1, own));
}
}  // namespace delio::map
