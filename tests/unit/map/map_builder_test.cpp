#include "delio/map/map_builder.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <tuple>

#include "delio/core/error.h"
#include "delio/map/simplemap.h"
#include "map_support.h"
#include "memory_limit.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using map::MapBuilder;
using map::MapOptions;
using mrpt::maps::CSimplePointsMap;
using test::everything;
using test::kHere;
using test::kStamp;
using test::poseAt;
using test::randomCloud;

CSimplePointsMap oneCloud(std::initializer_list<mrpt::math::TPoint3Df> points) {
    CSimplePointsMap cloud;
    for (const auto& p : points) cloud.insertPoint(p.x, p.y, p.z);
    return cloud;
}

using Voxel = std::tuple<int, int, int>;
Voxel voxelOf(double x, double y, double z, double size) {
    return {static_cast<int>(std::floor(x / size)), static_cast<int>(std::floor(y / size)),
            static_cast<int>(std::floor(z / size))};
}

TEST(MapBuilder, KeyframesByDistanceAndByAngle) {
    MapOptions options = everything();
    options.keyframeDistance_m = 2;
    options.keyframeAngle_deg = 10;
    MapBuilder builder(options);
    const auto cloud = randomCloud(10, 1);
    const auto offer = [&](double x, double yaw_deg) {
        return builder.add(0, poseAt(x, 0, 0, mrpt::DEG2RAD(yaw_deg), 0, 0), cloud, kHere, kStamp);
    };
    EXPECT_TRUE(offer(0, 0));
    EXPECT_FALSE(offer(1.9, 0));
    EXPECT_TRUE(offer(2.1, 0));
    EXPECT_FALSE(offer(0.2, 0)) << "1.9 m from the last keyframe";
    EXPECT_FALSE(offer(2.1, -9));
    EXPECT_TRUE(offer(2.1, -11));
    EXPECT_FALSE(offer(2.1, -19));
    EXPECT_TRUE(offer(2.1, 349 + 11)) << "11 degrees, over the turn of the circle";
    EXPECT_EQ(builder.keyframes(), 4U);
}

TEST(MapBuilder, UnusablePointsAreDroppedAndAnEmptyScanIsNoKeyframe) {
    MapOptions options = everything();
    options.minRange_m = 2.5;
    options.maxRange_m = 60;
    MapBuilder builder(options);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(builder.add(0, kHere, CSimplePointsMap(), kHere, kStamp));
    EXPECT_FALSE(
        builder.add(0, kHere, oneCloud({{nan, 3, 0}, {1, 1, 1}, {0, 61, 0}}), kHere, kStamp));
    EXPECT_TRUE(builder.add(
        0, kHere, oneCloud({{nan, 3, 0}, {0, 0, 3}, {0, inf, 0}, {3, nan, 0}, {0, 59, 0}}), kHere,
        kStamp));
    const auto points = map::cloudOf(builder.build({kHere}).points);
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(points.getPointsBufferRef_z()[0], 3);
    EXPECT_EQ(points.getPointsBufferRef_y()[1], 59);
}

TEST(MapBuilder, OnePointPerVoxelAsBruteForceFindsIt) {
    for (const double size : {0.2, 1.0, 3.3}) {
        MapOptions options = everything();
        options.voxelSize_m = size;
        MapBuilder builder(options);
        const auto cloud = randomCloud(20000, 2);
        builder.add(0, kHere, cloud, kHere, kStamp);
        std::set<Voxel> taken;
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < cloud.size(); ++i)
            if (taken
                    .insert(voxelOf(cloud.getPointsBufferRef_x()[i],
                                    cloud.getPointsBufferRef_y()[i],
                                    cloud.getPointsBufferRef_z()[i], size))
                    .second)
                expected.push_back(i);
        const auto points = map::cloudOf(builder.build({kHere}).points);
        ASSERT_EQ(points.size(), expected.size()) << size;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            const std::size_t i = expected[k];
            EXPECT_EQ(points.getPointsBufferRef_x()[k], cloud.getPointsBufferRef_x()[i]);
            EXPECT_EQ(points.getPointsBufferRef_y()[k], cloud.getPointsBufferRef_y()[i]);
            EXPECT_EQ(points.getPointsBufferRef_z()[k], cloud.getPointsBufferRef_z()[i]);
            EXPECT_EQ(points.getPointIntensity_fast(k), cloud.getPointIntensity_fast(i));
        }
    }
}

TEST(MapBuilder, WhatSeveralScansSawIsThereOnce) {
    MapOptions options = everything();
    options.voxelSize_m = 0.5;
    const auto cloud = randomCloud(5000, 3);
    const auto pointsOfTwo = [&](const Isometry3d& second) {
        MapBuilder builder(options);
        builder.add(0, kHere, cloud, kHere, kStamp);
        builder.add(1, second, cloud, kHere, kStamp);
        return map::cloudOf(builder.build({kHere, second}).points).size();
    };
    EXPECT_EQ(2 * pointsOfTwo(kHere), pointsOfTwo(poseAt(100, 0, 0)));
    // What was thought to lie apart and comes together in the end is there once as well.
    MapBuilder builder(options);
    builder.add(0, kHere, cloud, kHere, kStamp);
    builder.add(1, poseAt(100, 0, 0), cloud, kHere, kStamp);
    EXPECT_EQ(builder.keyframes(), 2U);
    EXPECT_EQ(map::cloudOf(builder.build({kHere, kHere}).points).size(), pointsOfTwo(kHere));
}

TEST(MapBuilder, ScansBetweenKeyframesAddWhatWasNotSeenBefore) {
    MapOptions options = everything();
    options.voxelSize_m = 0.5;
    options.keyframeDistance_m = 100;
    MapBuilder builder(options);
    const std::vector<Isometry3d> poses = {kHere, poseAt(1, 0, 0)};
    EXPECT_TRUE(builder.add(0, poses[0], oneCloud({{10.1F, 0, 0}}), kHere, kStamp));
    EXPECT_FALSE(builder.add(1, poses[1], oneCloud({{9.1F, 0, 0}, {20.1F, 0, 0}}), kHere, kStamp));
    const auto points = map::cloudOf(builder.build(poses).points);
    ASSERT_EQ(points.size(), 2U) << "the first place is one voxel, seen twice";
    EXPECT_NEAR(points.getPointsBufferRef_x()[1], 21.1, 1e-4);
    EXPECT_EQ(builder.keyframes(), 1U);
    EXPECT_EQ(builder.build(poses).keyPoses.size(), 1U);
}

TEST(MapBuilder, WhatMovesIsLeftOut) {
    MapBuilder builder(everything());
    EXPECT_TRUE(builder.add(0, kHere, oneCloud({{10, 0, 0}, {11, 0, 0}, {12, 0, 0}}), kHere, kStamp,
                            {0, 1, 0}));
    const auto points = map::cloudOf(builder.build({kHere}).points);
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(points.getPointsBufferRef_x()[1], 12);
    EXPECT_EQ(map::pointsOf(builder.build({kHere}).simplemap).size(), 2U);
    EXPECT_FALSE(builder.add(1, poseAt(50, 0, 0), oneCloud({{10, 0, 0}}), kHere, kStamp, {1}));
}

std::size_t memoryInUse_mb() {
    std::size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) >> 20;
}

TEST(MapBuilder, MemoryGrowsWithTheSpaceAndNotWithTheScans) {
    if (!test::MemoryLimit::works()) GTEST_SKIP() << "the sanitizer keeps what is freed";
    MapOptions options = everything();
    options.voxelSize_m = 0.2;
    options.keyframeDistance_m = 0;  // every scan is a keyframe
    MapBuilder builder(options);
    const auto cloud = randomCloud(50000, 9);
    const auto drive = [&](std::size_t scans) {
        for (std::size_t i = 0; i < scans; ++i) builder.add(0, kHere, cloud, kHere, kStamp);
    };
    drive(5);
    const std::size_t before = memoryInUse_mb();
    drive(200);  // 200 x 0.8 MB, were they kept in memory
    EXPECT_LT(memoryInUse_mb(), before + 30);
    EXPECT_EQ(builder.keyframes(), 205U);
    // Written one scan after the other as well.
    const test::TemporaryFolder folder;
    map::saveSimplemap(builder.build({kHere}).simplemap, folder / "map.simplemap");
    EXPECT_LT(memoryInUse_mb(), before + 30);
}

TEST(MapBuilder, KeyframesLeaveNoFileBehind) {
    const test::TemporaryFolder folder;
    MapBuilder builder(everything(), "lidar", folder.path().string());
    builder.add(0, kHere, randomCloud(100, 10), kHere, kStamp);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_EQ(map::pointsOf(builder.build({kHere}).simplemap).size(), 100U);
    MapBuilder nowhere(everything(), "lidar", folder / "no/such/folder");
    EXPECT_THROW(nowhere.add(0, kHere, randomCloud(9, 1), kHere, kStamp), Error);
}

TEST(MapBuilder, FinalPosesAndTheSensorsPlaceAreApplied) {
    MapBuilder builder(everything());
    const auto sensor = poseAt(0.5, -0.2, 1.7, 1.2, 0.1, -0.3);
    const auto cloud = randomCloud(200, 4);
    builder.add(3, kHere, cloud, sensor, kStamp);
    std::vector<Isometry3d> poses(4, kHere);
    poses[3] = poseAt(40, -7, 3, -2.5, 0.2, 0.4);
    const auto points = map::cloudOf(builder.build(poses).points);
    ASSERT_EQ(points.size(), cloud.size());
    const Eigen::Matrix4d T = poses[3].matrix() * sensor.matrix();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Eigen::Vector4d p(cloud.getPointsBufferRef_x()[i], cloud.getPointsBufferRef_y()[i],
                                cloud.getPointsBufferRef_z()[i], 1);
        const Eigen::Vector4d q = T * p;
        EXPECT_NEAR(points.getPointsBufferRef_x()[i], q.x(), 1e-4);
        EXPECT_NEAR(points.getPointsBufferRef_y()[i], q.y(), 1e-4);
        EXPECT_NEAR(points.getPointsBufferRef_z()[i], q.z(), 1e-4);
    }
    // The simplemap tells the same.
    const auto fromSimplemap = map::pointsOf(builder.build(poses).simplemap);
    ASSERT_EQ(fromSimplemap.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(fromSimplemap.getPointsBufferRef_x()[i], points.getPointsBufferRef_x()[i],
                    1e-4);
        EXPECT_EQ(fromSimplemap.getPointIntensity_fast(i), points.getPointIntensity_fast(i));
    }
}

TEST(MapBuilder, PointsStayInPlaceWhereAPoseIsKnownBetter) {
    MapBuilder builder(everything());
    const auto sensor = poseAt(0.5, -0.2, 1.7, 1.2, 0.1, -0.3);
    builder.add(0, kHere, randomCloud(50, 3), sensor, kStamp);
    builder.add(1, kHere, randomCloud(50, 4), sensor, kStamp);
    std::vector<Isometry3d> poses = {kHere, poseAt(4, -7, 3, -0.5, 0.2, 0.4)};
    const auto before = map::cloudOf(builder.build(poses).points);
    const Isometry3d better = poseAt(4.1, -7.2, 3, -0.4, 0.2, 0.4);
    builder.keepInPlace(1, better.inverse() * poses[1]);
    builder.keepInPlace(0, better);  // not the latest scan
    poses[1] = better;
    const auto after = map::cloudOf(builder.build(poses).points);
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < after.size(); ++i) {
        EXPECT_NEAR(after.getPointsBufferRef_x()[i], before.getPointsBufferRef_x()[i], 1e-4);
        EXPECT_NEAR(after.getPointsBufferRef_y()[i], before.getPointsBufferRef_y()[i], 1e-4);
        EXPECT_NEAR(after.getPointsBufferRef_z()[i], before.getPointsBufferRef_z()[i], 1e-4);
    }
}

TEST(MapBuilder, MissingPosesAreAnError) {
    MapBuilder builder(everything());
    builder.add(5, kHere, randomCloud(10, 5), kHere, kStamp);
    EXPECT_THROW(map::cloudOf(builder.build(std::vector<Isometry3d>(5, kHere)).points), Error);
    EXPECT_THROW(builder.build({}).simplemap, Error);
    EXPECT_THROW(builder.build({}).keyPoses, Error);
}
}  // namespace
