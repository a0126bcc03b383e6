#include "core/voxel_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/voxel_grid.h"
#include "ring_scan.h"

namespace delio::odometry {
namespace {
constexpr double kSize = 0.5, kRadius = 20;

TEST(VoxelBall, HoldsNoVoxelOfAPointOutside) {
    test::Noise noise;
    // Far from the origin, and beyond where keys begin anew.
    for (const double away : {0.0, 4000.0, -0.5 * (1 << 20) * kSize - 3}) {
        const Eigen::Vector3d centre(away, -away, 7.3);
        for (unsigned levels = 0; levels < 5; ++levels) {
            const VoxelBall ball(centre, kRadius, kSize, levels);
            int held = 0, inside = 0;
            for (int i = 0; i < 20000; ++i) {
                const Eigen::Vector3d offset = 2 * kRadius * noise.uniform() * noise.direction();
                const auto key = coarserKey(voxelKey(centre + offset, kSize), levels);
                held += ball.holds(key);
                if (offset.norm() > kRadius) {
                    EXPECT_FALSE(ball.holds(key)) << offset.transpose();
                    continue;
                }
                ++inside;
            }
            // Of the smallest voxels nearly all.
            EXPECT_GT(held, (levels == 0 ? 0.85 : 0.1) * inside) << levels;
        }
    }
}

TEST(VoxelBall, HoldsNothingWhereItIsSmallerThanAVoxel) {
    const Eigen::Vector3d centre(0.25, 0.25, 0.25);
    EXPECT_FALSE(VoxelBall(centre, 0.2, kSize).holds(voxelKey(centre, kSize)));
    EXPECT_TRUE(VoxelBall(centre, 2, kSize).holds(voxelKey(centre, kSize)));
}
}  // namespace
}  // namespace delio::odometry
