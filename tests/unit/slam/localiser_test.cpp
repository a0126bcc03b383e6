#include "delio/slam/localiser.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <filesystem>
#include <string>

#include "../places/town_map.h"
#include "delio/core/error.h"
#include "slam/place_listeners.h"
#include "test_data.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;

// A LiDAR that is mounted ahead of the vehicle's middle, as MRPT's observations have it.
TEST(Localiser, TakesObservationsAndGivesPosesWithCovariance) {
    const test::TemporaryFolder folder;
    {
        const TownDrive drive(roundTheBlock(0));
        StoredMap::save(drive.content, fileIn(folder));
    }
    const Eigen::Isometry3d sensor = test::poseAt(1.5, 0, 0.1);
    Localiser localiser(std::make_shared<const StoredMap>(fileIn(folder)));
    test::Noise noise(21);
    std::optional<mrpt::poses::CPose3DPDFGaussian> found;
    constexpr std::size_t kScans = 10;
    const auto pose = [](std::size_t i) {
        return test::poseAt(10 + 0.8 * static_cast<double>(i), 0, 0);
    };
    for (std::size_t i = 0; i < kScans; ++i) {
        const auto points =
            test::ringScan(town(), pose(i) * sensor, {32, 720, -24, 12, 0.01}, noise).points;
        mrpt::obs::CObservationPointCloud observation;
        auto cloud = mrpt::maps::CSimplePointsMap::Create();
        for (Eigen::Index k = 0; k < points.cols(); ++k)
            cloud->insertPoint(points(0, k), points(1, k), points(2, k));
        observation.pointcloud = cloud;
        observation.sensorPose = toMrpt(sensor);
        observation.timestamp = mrpt::Clock::fromDouble(1e9 + 0.1 * static_cast<double>(i));
        found = localiser.process(observation);
        EXPECT_EQ(found.has_value(), i >= 2) << i;
    }
    ASSERT_TRUE(found);
    EXPECT_LT(test::metresBetween(fromMrpt(found->mean), pose(kScans - 1)), 0.05);
    EXPECT_GT(found->cov(0, 0), 0);
    EXPECT_LT(found->cov(0, 0), 0.01);
    EXPECT_THROW(localiser.process(mrpt::obs::CObservationIMU()), Error);
}

// The map's file is cut off while it is in use.
TEST(Localiser, EndsWhereTheMapCannotBeRead) {
    const test::TemporaryFolder folder;
    {
        const TownDrive drive(roundTheBlock(0));
        StoredMap::save(drive.content, fileIn(folder));
    }
    Localiser localiser(std::make_shared<const StoredMap>(fileIn(folder)));
    std::filesystem::resize_file(fileIn(folder), 100);
    test::Noise noise(21);
    Scan scan = test::scanOf(seenFrom(town(), test::poseAt(10, 0, 0), noise));
    for (int i = 0; i < 3; ++i) {
        scan.stamp_s = 0.1 * i;
        try {
            localiser.process(scan);
            FAIL() << i;
        } catch (const Error& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find("localisation stopped"), std::string::npos) << what;
            EXPECT_NE(what.find(fileIn(folder)), std::string::npos) << what;
        }
    }
}

TEST(MapFollower, WithoutAHistoryItKeepsTheLastFix) {
    const test::TemporaryFolder folder;
    {
        const TownDrive drive(roundTheBlock(0));
        StoredMap::save(drive.content, fileIn(folder));
    }
    MapFollower follower(MapTracker(std::make_shared<const StoredMap>(fileIn(folder)), {}, {}),
                         History::Last);
    test::Noise noise(3);
    const auto poses = roundTheBlock(0);
    Scan scan;
    Step step;
    for (std::size_t i = 0; i < 6; ++i) {
        step.used.points = seenFrom(town(), poses[i], noise);
        Increment increment{Eigen::Isometry3d::Identity(), 1e-5 * Matrix6::Identity()};
        if (i > 0) increment.pose = poses[i - 1].inverse() * poses[i];
        follower.add({i, scan, step, increment, poses[i]});
        EXPECT_EQ(follower.fixes().size(), 1U);
    }
    EXPECT_LT(test::metresBetween(follower.fixes().back().vehicle.pose, poses[5]), 0.1);
}
}  // namespace
