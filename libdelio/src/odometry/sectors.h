#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace delio::odometry {
constexpr int kSectors = 12;

/** A value for each of the sectors about the sensor's z axis. */
using Sectors = Eigen::Array<double, kSectors, 1>;

/** The sector that a point (sensor's frame) lies in. */
template <typename Point>
int sectorOf(const Eigen::MatrixBase<Point>& point) {
    const double turn = std::atan2(point.y(), point.x()) / (2 * M_PI) + 0.5;
    return std::min(static_cast<int>(turn * kSectors), kSectors - 1);
}

/** How many sectors the weights (not negative) are spread over: (sum w)^2 / sum w^2, which is n for
 *  n equal weights. */
inline double spreadOf(const Sectors& weights) {
    const double squares = weights.square().sum();
    return squares > 0 ? weights.sum() * weights.sum() / squares : 0;
}
}  // namespace delio::odometry
