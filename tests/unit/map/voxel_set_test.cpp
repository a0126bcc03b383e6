#include "map/voxel_set.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "ring_scan.h"

namespace {
using namespace delio;

TEST(VoxelSet, TakesVoxelsAsBruteForceDoes) {
    constexpr double kSize = 0.7;
    map::VoxelSet voxels(kSize);
    std::set<std::tuple<int, int, int>> taken;
    test::Noise noise;
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d p = 4 * noise.normals();
        const Eigen::Array3i cell = (p / kSize).array().floor().cast<int>();
        const std::tuple<int, int, int> key{cell.x(), cell.y(), cell.z()};
        EXPECT_EQ(voxels.insert(p), taken.insert(key).second) << i;
    }
}

TEST(VoxelSet, WithoutASizeEveryPointHasAVoxelOfItsOwn) {
    map::VoxelSet voxels(0);
    EXPECT_TRUE(voxels.insert({1, 2, 3}));
    EXPECT_TRUE(voxels.insert({1, 2, 3}));
}
}  // namespace
