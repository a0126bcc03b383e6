#include "core/voxel_grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "ring_scan.h"

namespace {
using delio::numberVoxels;
using delio::voxelCentroids;

Eigen::Matrix3Xf cloud(Eigen::Index count, double size) {
    delio::test::Noise noise;
    Eigen::Matrix3Xf points(3, count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) points(k, i) = static_cast<float>(size * noise.uniform());
    return points;
}

// Sizes whose inverse is a float: which voxel a point at a border is in is then no matter of
// rounding.
TEST(VoxelGrid, AgreesWithAPlainMap) {
    for (const double size : {0.5, 2.0, 0.125}) {
        const auto points = cloud(3000, 4);
        std::map<std::array<int, 3>, std::vector<Eigen::Index>> voxels;
        std::vector<std::array<int, 3>> inOrder;
        const auto numbers = numberVoxels(points, size);
        ASSERT_EQ(numbers.ofPoint.size(), 3000U);
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            std::array<int, 3> key{};
            for (int k = 0; k < 3; ++k)
                key[static_cast<std::size_t>(k)] =
                    static_cast<int>(std::floor(static_cast<double>(points(k, i)) / size));
            auto& inVoxel = voxels[key];
            if (inVoxel.empty()) inOrder.push_back(key);
            inVoxel.push_back(i);
            // Numbered as they are first met.
            EXPECT_EQ(inOrder[numbers.ofPoint[static_cast<std::size_t>(i)]], key);
        }
        EXPECT_EQ(numbers.voxels, static_cast<Eigen::Index>(voxels.size()));
        const auto centroids = voxelCentroids(points, size);
        ASSERT_EQ(centroids.cols(), numbers.voxels);
        for (std::size_t v = 0; v < inOrder.size(); ++v) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const auto i : voxels[inOrder[v]]) sum += points.col(i).cast<double>();
            sum /= static_cast<double>(voxels[inOrder[v]].size());
            const auto found = centroids.col(static_cast<Eigen::Index>(v)).cast<double>();
            EXPECT_LT((found - sum).norm(), 1e-5);
        }
    }
}

TEST(VoxelGrid, ZeroIsABorderAndNotTheMiddleOfAVoxel) {
    Eigen::Matrix3Xf points(3, 4);
    points << 0.1F, -0.1F, -0.9F, -1.1F, 0, 0, 0, 0, 0, 0, 0, 0;
    EXPECT_EQ(numberVoxels(points, 1).ofPoint, (std::vector<std::uint32_t>{0, 1, 1, 2}));
}

TEST(VoxelGrid, NeighboursOnEachAxisAreTold) {
    Eigen::Matrix3Xf points(3, 7);
    points << 0, 1, -1, 0, 0, 0, 0,  //
        0, 0, 0, 1, -1, 0, 0,        //
        0, 0, 0, 0, 0, 1, -1;
    points.array() += 0.5F;
    EXPECT_EQ(numberVoxels(points, 1).voxels, 7);
    EXPECT_EQ(numberVoxels(points * 1000, 1).voxels, 7);
}

TEST(VoxelGrid, WhatIsTooFarForAnyKeyIsTakenForTheFarthest) {
    Eigen::Matrix3Xf points = Eigen::Matrix3Xf::Zero(3, 4);
    points.row(1) << 1e7F, 3e38F, -1e7F, -3e38F;
    EXPECT_EQ(numberVoxels(points, 1).ofPoint, (std::vector<std::uint32_t>{0, 0, 1, 1}));
}

TEST(VoxelGrid, Empty) {
    EXPECT_EQ(numberVoxels({}, 1).voxels, 0);
    EXPECT_EQ(voxelCentroids({}, 1).cols(), 0);
}
}  // namespace

namespace delio::odometry {
namespace {
Eigen::Matrix3Xd counted(Eigen::Index count) {
    Eigen::Matrix3Xd points(3, count);
    for (Eigen::Index i = 0; i < count; ++i) points.col(i).setConstant(static_cast<double>(i));
    return points;
}

TEST(Sample, TakesAFewEvenlyOverTheOrder) {
    const auto few = sample(counted(10), 4);
    ASSERT_EQ(few.cols(), 4);
    EXPECT_EQ(few.row(0), Eigen::RowVector4d(0, 3, 6, 9));
    EXPECT_EQ(sample(counted(9), 4).cols(), 3);
}

TEST(Sample, TakesAllWhereThereAreFew) {
    EXPECT_EQ(sample(counted(4), 4), counted(4));
    EXPECT_EQ(sample(counted(0), 4).cols(), 0);
    EXPECT_EQ(sample(counted(4), std::numeric_limits<Eigen::Index>::max()).cols(), 4);
}
}  // namespace
}  // namespace delio::odometry
