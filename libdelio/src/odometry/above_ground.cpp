#include "odometry/above_ground.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace delio::odometry {
LevelGrid::LevelGrid(double cell, double radius)
    : cell_(static_cast<float>(cell)),
      half_(static_cast<int>(std::ceil(radius / cell))),
      width_(2 * half_ + 1) {}

std::size_t LevelGrid::at(float x, float y) const {
    const int i = static_cast<int>(std::lround(x / cell_)) + half_;
    const int j = static_cast<int>(std::lround(y / cell_)) + half_;
    return isInside(i, j) ? number(i, j) : size();
}

std::vector<float> heightsAboveGround(const Eigen::Matrix3Xf& points, double radius) {
    constexpr float kNone = std::numeric_limits<float>::max();
    const LevelGrid grid(1, radius);
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

namespace {
/** Which heights are taken near each cell: a bit for each quarter of a metre, up to 16 m. */
class Levels {
 public:
    Levels(const Eigen::Matrix3Xf& points, const std::vector<float>& heights, double radius)
        : grid_(1, radius), about_(grid_.size() + 1) {
        std::vector<std::uint64_t> taken(grid_.size() + 1);
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            taken[cellOf(points.col(i))] |= std::uint64_t{1}
                                            << levelOf(heights[static_cast<std::size_t>(i)]);
        for (std::size_t cell = 0; cell < grid_.size(); ++cell)
            if (taken[cell])
                grid_.forNeighbours(cell, [&](std::size_t near) { about_[near] |= taken[cell]; });
    }

    /** True where a point lies about `least` to `most` metres below `height`, never less. */
    bool areTakenBelow(const Eigen::Vector3f& point, float height, float least, float most) const {
        const int high = levelOf(height - least) - 1, low = levelOf(height - most);
        if (high < 0) return height >= least;  // the ground itself
        const std::uint64_t upToHigh = ~std::uint64_t{0} >> (kLevels - 1 - high),
                            fromLow = ~std::uint64_t{0} << low;
        return (about_[cellOf(point)] & upToHigh & fromLow) != 0;
    }

 private:
    static constexpr int kLevels = 64;
    static int levelOf(float height) {
        constexpr float kLevel_m = 0.25F;
        return static_cast<int>(std::clamp<float>(height / kLevel_m, 0, kLevels - 1));
    }
    std::size_t cellOf(const Eigen::Vector3f& point) const {
        return grid_.at(point.x(), point.y());
    }

    LevelGrid grid_;
    std::vector<std::uint64_t> about_;
};
}  // namespace

Eigen::Matrix3Xf standingPoints(const Eigen::Matrix3Xf& points, const Eigen::Matrix3f& upright,
                                double least, double radius) {
    constexpr float kGap_m = 1.5F, kRings_rad = 0.04F;  // rings of 16 lie 2 deg apart
    const Eigen::Matrix3Xf level = upright * points;
    const auto heights = heightsAboveGround(level, radius);
    const Levels levels(level, heights, radius);
    const auto lowest = static_cast<float>(least);
    Eigen::Matrix3Xf standing(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const float height = heights[static_cast<std::size_t>(i)],
                    gap = std::max(kGap_m, kRings_rad * points.col(i).norm());
        if (height > lowest && levels.areTakenBelow(level.col(i), height, lowest, gap))
            standing.col(count++) = points.col(i);
    }
    standing.conservativeResize(3, count);
    return standing;
}
}  // namespace delio::odometry
