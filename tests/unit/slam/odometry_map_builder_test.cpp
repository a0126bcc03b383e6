#include "delio/slam/odometry_map_builder.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/img/CImage.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <Eigen/Dense>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/map/simplemap.h"
#include "slam_drive.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::obs::CObservation;
using mrpt::obs::CObservationPointCloud;

CObservation::Ptr observationOf(const Scan& scan) {
    const auto observation = CObservationPointCloud::Create();
    observation->pointcloud = scan.points;
    observation->timestamp = scan.time;
    observation->sensorPose = toMrpt(scan.sensorPose);
    return observation;
}

std::vector<Scan> scans() { return slam_test::scansOf(slam_test::drive(6), slam_test::mounting()); }

mrpt::poses::CPose3D meanOf(const OdometryMapBuilder& builder) {
    return builder.getCurrentPoseEstimation()->getMeanVal();
}

TEST(OdometryMapBuilder, PosesAreThoseOfSlam) {
    OdometryMapBuilder builder;
    Slam slam(makeOdometry(Options::ofProfile("accurate")));
    double volume = 0;
    for (const Scan& scan : scans()) {
        ASSERT_TRUE(builder.processObservation(observationOf(scan)));
        slam.process(scan);
        const auto pose = fromMrpt(meanOf(builder));
        EXPECT_TRUE(pose.isApprox(slam.trajectory().poses.back(), 1e-9));
        const double now = builder.getCurrentPoseEstimation()->getCovariance().trace();
        EXPECT_GE(now, volume);
        volume = now;
    }
    EXPECT_GT(volume, 0);
    EXPECT_FALSE(builder.latestStep().predicted);
}

TEST(OdometryMapBuilder, TheMapHasTheKeyframes) {
    OdometryMapBuilder builder;
    mrpt::obs::CActionCollection action;
    for (const Scan& scan : scans()) {
        mrpt::obs::CSensoryFrame frame;
        frame.insert(observationOf(scan));
        builder.processActionObservation(action, frame);
    }
    EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 3U);  // 2.5 m of path, one a metre
    mrpt::maps::CSimpleMap map;
    builder.getCurrentlyBuiltMap(map);
    ASSERT_EQ(map.size(), 3U);
    const auto points = map::pointsOf(map);
    const auto metric =
        builder.getCurrentlyBuiltMetricMap()->mapByClass<mrpt::maps::CSimplePointsMap>();
    ASSERT_TRUE(metric);
    EXPECT_GT(metric->size(), 1000U);
    EXPECT_LT(metric->size(), points.size());
    const test::TemporaryFolder folder;
    builder.saveCurrentMapToFile(folder / "map.simplemap");
    EXPECT_EQ(map::loadSimplemap(folder / "map.simplemap").size(), 3U);
    builder.saveCurrentEstimationToImage(folder / "map.png");
    mrpt::img::CImage picture;
    ASSERT_TRUE(picture.loadFromFile(folder / "map.png"));
    EXPECT_EQ(picture.getWidth(), 1024U);
}

TEST(OdometryMapBuilder, UpdatesOfTheMapCanBeSwitchedOff) {
    OdometryMapBuilder builder;
    builder.enableMapUpdating(false);
    for (const Scan& scan : scans()) builder.processObservation(observationOf(scan));
    EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 0U);
    EXPECT_GT(meanOf(builder).norm(), 1);
}

TEST(OdometryMapBuilder, BeginsWhereItIsTold) {
    OdometryMapBuilder builder;
    const auto drive = scans();
    builder.processObservation(observationOf(drive[0]));
    const mrpt::poses::CPosePDFGaussian start({10, 20, 0.5});
    builder.initialize({}, &start);
    EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 0U);
    builder.processObservation(observationOf(drive[0]));
    EXPECT_TRUE(fromMrpt(meanOf(builder))
                    .isApprox(fromMrpt(mrpt::poses::CPose3D(10, 20, 0, 0.5, 0, 0)), 1e-9));
    mrpt::maps::CSimpleMap map;
    builder.getCurrentlyBuiltMap(map);
    EXPECT_THROW(builder.initialize(map), Error);
}

TEST(OdometryMapBuilder, TakesSamplesOfImuAndWheelsAndPassesOverOthers) {
    OdometryMapBuilder builder;
    EXPECT_TRUE(builder.processObservation(mrpt::obs::CObservationIMU::Create()));
    EXPECT_TRUE(builder.processObservation(mrpt::obs::CObservationOdometry::Create()));
    EXPECT_FALSE(builder.processObservation(mrpt::obs::CObservation2DRangeScan::Create()));
    EXPECT_THROW(builder.processObservation(nullptr), Error);
    EXPECT_THROW(builder.latestStep(), Error);
    EXPECT_THROW(builder.saveCurrentEstimationToImage("map.png"), Error);
}

TEST(OdometryMapBuilderOptions, AreLoadedStrictly) {
    OdometryMapBuilderOptions options;
    const auto load = [&](const std::string& text) {
        options.loadFromConfigFile(mrpt::config::CConfigFileMemory(text), "mine");
    };
    load("[mine]\nkeyframe_distance = 2\n[mine.scan]\nmax_range = 55\n[other]\nx = 1\n");
    EXPECT_EQ(options.keyframe_distance, 2);
    mrpt::config::CConfigFileMemory written;
    options.saveToConfigFile(written, "mine");
    EXPECT_EQ(written.read_double("mine.scan", "max_range", 0), 55);
    OdometryMapBuilderOptions again;
    again.loadFromConfigFile(written, "mine");
    EXPECT_EQ(again.keyframe_distance, 2);
    for (const char* wrong : {"[mine]\nkeyframe = 2\n", "[mine]\nkeyframe_distance = far\n",
                              "[mine.scans]\nmax_range = 55\n", "[mine]\nprofile = best\n"})
        EXPECT_THROW(load(wrong), Error) << wrong;
}
}  // namespace
