#include "delio/map/simplemap.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/map/map_builder.h"
#include "map_support.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using map::MapBuilder;
using map::MapOptions;
using test::everything;
using test::kHere;
using test::kStamp;
using test::poseAt;
using test::randomCloud;

TEST(Simplemap, ReloadsEqualAndRepeatsByteForByte) {
    const test::TemporaryFolder folder;
    const auto sensor = poseAt(0, 0, 1.7, 0.1, 0, 0);
    const std::vector<Isometry3d> poses = {kHere, poseAt(5, 1, 0, 0.3, 0, 0)};
    for (const char* name : {"a.simplemap", "b.simplemap"}) {
        MapBuilder builder(MapOptions(), "velodyne");
        builder.add(0, poses[0], randomCloud(3000, 6), sensor, kStamp);
        builder.add(1, poses[1], randomCloud(3000, 7), sensor, kStamp);
        map::saveSimplemap(builder.build(poses).simplemap, folder / name);
    }
    EXPECT_EQ(test::readText(folder / "a.simplemap"), test::readText(folder / "b.simplemap"));

    const auto loaded = map::loadSimplemap(folder / "a.simplemap");
    ASSERT_EQ(loaded.size(), 2U);
    // MRPT's own reader makes the same of it.
    mrpt::maps::CSimpleMap byMrpt;
    EXPECT_TRUE(byMrpt.loadFromFile(folder / "a.simplemap"));
    EXPECT_EQ(byMrpt.size(), 2U);
    const auto pair = loaded.getAsPair(1);
    EXPECT_LT(test::metresBetween(fromMrpt(pair.pose->getMeanVal()), poses[1]), 1e-9);
    const auto scan = pair.sf->getObservationByClass<mrpt::obs::CObservationPointCloud>();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->sensorLabel, "velodyne");
    EXPECT_EQ(scan->timestamp, kStamp);
    EXPECT_FALSE(scan->isExternallyStored());
    EXPECT_LT(test::metresBetween(fromMrpt(scan->sensorPose), sensor), 1e-9);
    MapBuilder again((MapOptions()));
    again.add(0, poses[1], randomCloud(3000, 7), sensor, kStamp);
    const auto kept = again.build({poses[1]}).points;
    ASSERT_EQ(scan->pointcloud->size(), kept.size());
}

TEST(Simplemap, CutOffAnywhereIsAnError) {
    const test::TemporaryFolder folder;
    MapBuilder builder(everything());
    builder.add(0, kHere, randomCloud(300, 8), kHere, kStamp);
    map::saveSimplemap(builder.build({kHere}).simplemap, folder / "whole.simplemap");
    const std::string whole = test::readText(folder / "whole.simplemap");
    for (std::size_t length = 0;
         length<whole.size(); length += length + 40> whole.size() ? 1 : 17) {
        test::writeText(folder / "cut.simplemap", whole.substr(0, length));
        EXPECT_THROW(map::loadSimplemap(folder / "cut.simplemap"), Error) << length;
    }
    EXPECT_THROW(map::loadSimplemap(folder / "missing.simplemap"), Error);
    EXPECT_THROW(map::loadSimplemap(folder.path().string()), Error);
}

// MRPT uses the pose of a keyframe of version 0 whatever it is.
TEST(Simplemap, OfVersionZeroIsRefused) {
    const auto named = [](const std::string& name) {
        return static_cast<char>(0x80 | name.size()) + name;
    };
    const std::string frame =
        named("mrpt::obs::CSensoryFrame") + '\2' + std::string(4, '\0') + '\x88';
    const test::TemporaryFolder folder;
    const auto file = folder / "old.simplemap";
    for (const std::string& pose : {named("nullptr") + '\x88', frame}) {
        test::writeText(file, named("mrpt::maps::CSimpleMap") + '\0' + '\1' + std::string(3, '\0') +
                                  pose + frame + '\x88');
        try {
            map::loadSimplemap(file);
            FAIL();
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("version 0"), std::string::npos) << e.what();
        }
    }
}
}  // namespace
