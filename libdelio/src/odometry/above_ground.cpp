#include "odometry/above_ground.h"

#include <algorithm>
#include <cmath>
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

std::vector<Eigen::Index> standingPoints(const Eigen::Matrix3Xf& points,
                                         const Eigen::Matrix3f& upright, double least,
                                         double radius) {
    const auto heights = heightsAboveGround(upright * points, radius);
    std::vector<Eigen::Index> standing;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (double{heights[static_cast<std::size_t>(i)]} > least) standing.push_back(i);
    return standing;
}
}  // namespace delio::odometry
