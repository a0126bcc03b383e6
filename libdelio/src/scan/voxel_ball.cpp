#include "delio/scan/voxel_ball.h"

#include <algorithm>
#include <cmath>

#include "delio/scan/voxel_grid.h"

namespace delio::scan {
VoxelBall::VoxelBall(const Eigen::Vector3d& centre, double radius, double size, unsigned levels)
    : centre_(voxelKey(centre, size)), half_(std::ldexp(0.5, static_cast<int>(levels))) {
    // From the corner of the voxel that the centre is in to the middle of the other one: the centre
    // may be an edge of the smallest farther along each axis, and so may rounding.
    const double reach = radius / size - std::sqrt(3.0) * (half_ + 1.01);
    squared_ = std::pow(std::max(reach, 0.0), 2);
}

bool VoxelBall::holds(std::uint64_t key) const {
    constexpr std::int64_t kHalf = 1 << 20;  // see voxelKey()
    const auto squaredAlong = [&](unsigned shift) {
        const auto part = static_cast<std::int64_t>((key >> shift) - (centre_ >> shift));
        const std::int64_t steps = ((part + kHalf) & (2 * kHalf - 1)) - kHalf;
        const double away = static_cast<double>(steps) + half_;
        return away * away;
    };
    return squaredAlong(42) + squaredAlong(21) + squaredAlong(0) < squared_;
}
}  // namespace delio::scan
