#include "map/ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::map {
namespace {
constexpr double kCell_m = 15;
// Below this quantile lie reflections in wet streets and noise.
constexpr double kLowShare = 0.1;

std::int64_t cellIndex(double v) { return static_cast<std::int64_t>(std::floor(v / kCell_m)); }

std::uint64_t keyOf(std::int64_t column, std::int64_t row) {
    return (static_cast<std::uint64_t>(column) & 0xffffffff) << 32 |
           (static_cast<std::uint64_t>(row) & 0xffffffff);
}

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kSteepest = 0.5F;  // rise over run
constexpr float kPit_m = 0.5F;
// Farther than the middle of a car is from its edge, and near enough not to take a terrace for a
// thing on the street below it.
constexpr double kReach_m = 4;
constexpr double kIsland_m2 = 10;
constexpr float kRough_m = 0.2F;
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

GroundSurface::GroundSurface(const MapPoints& points, double cell) : cell_(cell) {
    if (points.empty()) return;
    Eigen::Vector3f low = points[0].position, high = low;
    for (const auto& point : points) {
        low = low.cwiseMin(point.position);
        high = high.cwiseMax(point.position);
    }
    const auto index = [&](float v) {
        return static_cast<std::int64_t>(std::floor(double{v} / cell_));
    };
    firstColumn_ = index(low.x());
    firstRow_ = index(low.y());
    columns_ = index(high.x()) - firstColumn_ + 1;
    rows_ = index(high.y()) - firstRow_ + 1;
    heights_.assign(static_cast<std::size_t>(columns_ * rows_), kNone);
    auto lows = lowsOf(points);
    for (const auto& each : lows) heights_[each.cell] = each.height;
    liftPits(lows);
    lowerWhatStandsOut(lows);
    findIslands(lows);
}

std::uint32_t GroundSurface::cellOf(const Eigen::Vector3f& point) const {
    const auto column =
        static_cast<std::int64_t>(std::floor(double{point.x()} / cell_)) - firstColumn_;
    const auto row = static_cast<std::int64_t>(std::floor(double{point.y()} / cell_)) - firstRow_;
    return static_cast<std::uint32_t>(row * columns_ + column);
}

float GroundSurface::height(std::int64_t column, std::int64_t row) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return kNone;
    return heights_[static_cast<std::size_t>(row * columns_ + column)];
}

std::vector<GroundSurface::Low> GroundSurface::lowsOf(const MapPoints& points) const {
    std::vector<Low> all;
    all.reserve(points.size());
    for (const auto& point : points) all.push_back({cellOf(point.position), point.position.z()});
    std::sort(all.begin(), all.end(), [](const Low& a, const Low& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.height < b.height;
    });
    std::size_t cells = 0;
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
        while (end < all.size() && all[end].cell == all[begin].cell) ++end;
        const double share = kLowShare * static_cast<double>(end - begin - 1);
        all[cells++] = all[begin + static_cast<std::size_t>(share)];
    }
    all.resize(cells);
    return all;
}

void GroundSurface::liftPits(std::vector<Low>& lows) {
    for (auto& low : lows) {
        const std::int64_t column = low.cell % columns_, row = low.cell / columns_;
        float around = std::numeric_limits<float>::infinity();
        for (std::int64_t r = row - 1; r <= row + 1; ++r)
            for (std::int64_t c = column - 1; c <= column + 1; ++c)
                if (r != row || c != column) around = std::fmin(around, height(c, r));
        const float deepest = kPit_m + kSteepest * static_cast<float>(cell_);
        if (std::isfinite(around) && low.height < around - deepest) low.height = around;
    }
    for (const auto& low : lows) heights_[low.cell] = low.height;
}

void GroundSurface::lowerWhatStandsOut(std::vector<Low>& lows) {
    const auto reach = static_cast<std::int64_t>(std::ceil(kReach_m / cell_));
    for (auto& low : lows) {
        const std::int64_t column = low.cell % columns_, row = low.cell / columns_;
        for (std::int64_t r = -reach; r <= reach; ++r)
            for (std::int64_t c = -reach; c <= reach; ++c) {
                const float other = height(column + c, row + r);
                if (!(other < low.height)) continue;
                const double away =
                    cell_ * std::hypot(static_cast<double>(c), static_cast<double>(r));
                low.height = std::min(low.height, other + kSteepest * static_cast<float>(away));
            }
    }
    for (const auto& low : lows) heights_[low.cell] = low.height;
}

template <typename Visit>
void GroundSurface::visitNeighbours(std::uint32_t cell, const Visit& visit) const {
    const std::int64_t column = cell % columns_, row = cell / columns_;
    const float steepest = kRough_m + 1.5F * kSteepest * static_cast<float>(cell_);
    for (std::int64_t r = row - 1; r <= row + 1; ++r)
        for (std::int64_t c = column - 1; c <= column + 1; ++c)
            if (std::abs(height(c, r) - heights_[cell]) <= steepest)  // not of NaN
                visit(static_cast<std::uint32_t>(r * columns_ + c));
}

void GroundSurface::findIslands(const std::vector<Low>& lows) {
    isGround_.assign(heights_.size(), false);
    std::vector<bool> met(heights_.size(), false);
    std::vector<std::uint32_t> piece;
    for (const auto& low : lows) {
        if (met[low.cell]) continue;
        piece = {low.cell};
        met[low.cell] = true;
        for (std::size_t i = 0; i < piece.size(); ++i)
            visitNeighbours(piece[i], [&](std::uint32_t other) {
                if (met[other]) return;
                met[other] = true;
                piece.push_back(other);
            });
        if (static_cast<double>(piece.size()) * cell_ * cell_ < kIsland_m2) continue;
        for (const auto cell : piece) isGround_[cell] = true;
    }
}

bool GroundSurface::isGround(double x, double y) const {
    const auto column = static_cast<std::int64_t>(std::floor(x / cell_)) - firstColumn_;
    const auto row = static_cast<std::int64_t>(std::floor(y / cell_)) - firstRow_;
    if (std::isnan(height(column, row))) return false;
    return isGround_[static_cast<std::size_t>(row * columns_ + column)];
}

double GroundSurface::at(double x, double y) const {
    // Between the middles of the four nearest cells, of those that have points.
    const double u = x / cell_ - static_cast<double>(firstColumn_) - 0.5;
    const double v = y / cell_ - static_cast<double>(firstRow_) - 0.5;
    const double column = std::floor(u), row = std::floor(v);
    double sum = 0, weights = 0;
    for (const int r : {0, 1})
        for (const int c : {0, 1}) {
            const float z =
                height(static_cast<std::int64_t>(column) + c, static_cast<std::int64_t>(row) + r);
            if (std::isnan(z)) continue;
            const double weight = (c ? u - column : 1 - u + column) * (r ? v - row : 1 - v + row);
            sum += weight * double{z};
            weights += weight;
        }
    return weights > 0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}
}  // namespace delio::map
