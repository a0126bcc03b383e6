#include <gtest/gtest.h>

#include <filesystem>
#include <new>

#include "delio/core/error.h"
#include "delio/map/map_builder.h"
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
using mrpt::maps::CPointsMapXYZI;
using test::everything;
using test::kHere;
using test::kStamp;
using test::poseAt;
using test::randomCloud;

void expectSamePoints(const CPointsMapXYZI& a, const CPointsMapXYZI& b) {
    EXPECT_EQ(a.getPointsBufferRef_x(), b.getPointsBufferRef_x());
    EXPECT_EQ(a.getPointsBufferRef_y(), b.getPointsBufferRef_y());
    EXPECT_EQ(a.getPointsBufferRef_z(), b.getPointsBufferRef_z());
    EXPECT_EQ(a.getPointsBufferRef_intensity(), b.getPointsBufferRef_intensity());
}

/** A drive through overlapping clouds, one pose each. */
const std::vector<Isometry3d> kDrive = {kHere, poseAt(3, 0, 0, 0.1), poseAt(3.5, 1, 0, 0.1)};

/** Scans 0 and 2 of kDrive; in between, where `taken` says so, scan 1 taken back. */
MapBuilder builderOfDrive(double voxel_m, bool taken) {
    MapOptions options = everything();
    options.voxelSize_m = voxel_m;
    MapBuilder builder(options);
    const auto sensor = poseAt(0.3, 0, 1.7, 0.5, 0.1);
    builder.add(0, kDrive[0], randomCloud(3000, 11), sensor, kStamp);
    if (taken) {
        EXPECT_TRUE(builder.add(1, kDrive[1], randomCloud(3000, 12), sensor, kStamp));
        builder.undo();
    }
    EXPECT_TRUE(builder.add(2, kDrive[2], randomCloud(3000, 13), sensor, kStamp));
    return builder;
}

TEST(MapBuilder, UndoTakesAScanBackAsIfItHadNeverCome) {
    for (const double voxel_m : {0.0, 0.5, 2.0}) {
        const auto builder = builderOfDrive(voxel_m, true);
        const auto other = builderOfDrive(voxel_m, false);
        expectSamePoints(map::cloudOf(builder.build(kDrive).points),
                         map::cloudOf(other.build(kDrive).points));
        EXPECT_EQ(builder.keyframes(), other.keyframes());
        expectSamePoints(map::pointsOf(builder.build(kDrive).simplemap),
                         map::pointsOf(other.build(kDrive).simplemap));
        EXPECT_EQ(builder.build(kDrive).keyPoses.back().matrix(), kDrive[2].matrix());
    }
}

TEST(MapBuilder, UndoTakesBackTheLastScanOnly) {
    MapOptions options = everything();
    options.voxelSize_m = 0.5;
    MapBuilder builder(options);
    builder.undo();  // nothing to take back
    builder.add(0, kHere, randomCloud(500, 14), kHere, kStamp);
    const auto points = map::cloudOf(builder.build(kDrive).points);
    // No keyframe, and not a point that is new.
    EXPECT_FALSE(builder.add(1, kHere, randomCloud(500, 14), kHere, kStamp));
    builder.undo();
    builder.undo();
    EXPECT_EQ(builder.keyframes(), 1U);
    expectSamePoints(map::cloudOf(builder.build(kDrive).points), points);
}

TEST(MapBuilder, UndoTakesBackAFaultOfTheDisk) {
    const test::TemporaryFolder folder;
    const std::string later = folder / "later";
    MapBuilder builder(everything(), "lidar", later);
    EXPECT_FALSE(builder.add(0, kHere, randomCloud(9, 1), kHere, kStamp));
    EXPECT_THROW(builder.build({kHere}).simplemap, Error);
    builder.undo();
    std::filesystem::create_directory(later);
    EXPECT_TRUE(builder.add(0, kHere, randomCloud(9, 1), kHere, kStamp));
    EXPECT_EQ(map::pointsOf(builder.build({kHere}).simplemap).size(), 9U);
}

TEST(MapBuilder, AnAddThatThrowsLeavesTheMapAsItWas) {
    if (!test::MemoryLimit::works()) GTEST_SKIP() << "the sanitizer ends the process";
    MapOptions options = everything();
    options.voxelSize_m = 0.5;
    options.keyframeDistance_m = 100;
    MapBuilder builder(options);
    builder.add(0, kHere, randomCloud(500, 15), kHere, kStamp);
    const auto before = map::cloudOf(builder.build(kDrive).points);
    const auto large = randomCloud(2000000, 16, 4000);  // in nearly as many voxels
    {
        const test::MemoryLimit limit(100);  // 32 for the points, more for the voxels
        EXPECT_THROW(builder.add(1, kDrive[1], large, kHere, kStamp), std::bad_alloc);
    }
    expectSamePoints(map::cloudOf(builder.build(kDrive).points), before);
    builder.add(1, kDrive[1], randomCloud(500, 17), kHere, kStamp);
    MapBuilder other(options);
    other.add(0, kHere, randomCloud(500, 15), kHere, kStamp);
    other.add(1, kDrive[1], randomCloud(500, 17), kHere, kStamp);
    expectSamePoints(map::cloudOf(builder.build(kDrive).points),
                     map::cloudOf(other.build(kDrive).points));
}
}  // namespace
