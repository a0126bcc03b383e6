#include "recordings/odometry_samples.h"

#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include "bag_files.h"
#include "delio/core/geometry.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/scan_reader.h"

namespace delio::bag_test {
namespace {
/** nav_msgs/Odometry at x = stamp - kBegin_s, turned by 90 deg about z. */
std::string odometryMessage(double stamp_s, Kind kind) {
    test::WireWriter message(kind);
    message.header(stamp_s, "odom");
    message.text("axle");
    const double half = std::sqrt(0.5);
    for (const double value : {stamp_s - kBegin_s, 2.0, 3.0, 0.0, 0.0, half, half})
        message.real(value);
    for (int i = 0; i < 36 + 6 + 36; ++i) message.real(0);
    return message.message();
}

BagContents driveWithOdometry(int scans, Kind kind) {
    BagContents bag = drive(scans, kind);
    const std::string type = kind == Kind::kRos1 ? "nav_msgs/Odometry" : "nav_msgs/msg/Odometry";
    bag.topics.push_back({"/points/ground_truth", type});
    bag.topics.push_back({"/wheels", type});
    BagContents all = bag;
    all.messages.clear();
    for (std::size_t i = 0; i < bag.messages.size(); ++i) {
        const double at_s = kBegin_s + 0.05 * static_cast<double>(i);
        all.messages.push_back({2, at_s, odometryMessage(at_s + 100, kind)});
        all.messages.push_back({3, at_s, odometryMessage(at_s, kind)});
        all.messages.push_back(bag.messages[i]);
    }
    return all;
}

TEST(OdometrySamples, OfABagAreThoseOfTheTopicThatIsNoResult) {
    for (const Container& container : containers()) {
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, driveWithOdometry(6, container.kind));
        const auto reader = container.open({file.string(), "", "", ""});
        EXPECT_EQ(reader->recording().odometry, "/wheels") << container.name;
        while (reader->next()) continue;
        const auto samples = reader->takeOdometry();
        ASSERT_EQ(samples.size(), 12U) << container.name;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double since_s = 0.05 * static_cast<double>(i);
            EXPECT_NEAR(samples[i].stamp_s, kBegin_s + since_s, 1e-6);
            EXPECT_TRUE(
                samples[i].pose.translation().isApprox(Eigen::Vector3d(since_s, 2, 3), 1e-6));
            EXPECT_NEAR(rotationLog(samples[i].pose.linear()).z(), M_PI / 2, 1e-9);
            EXPECT_FALSE(samples[i].sensorPose);
        }
    }
}

TEST(OdometrySamples, OfABagHaveThePoseInTfStatic) {
    BagContents bag = driveWithOdometry(3, Kind::kRos1);
    bag.topics.push_back({"/tf_static", "tf2_msgs/TFMessage"});
    bag.messages.push_back(
        {4, kBegin_s + 1,
         transformsMessage({{"/velodyne", {1, 0, 2}}, {"axle", {1, 3, 2.5}}}, Kind::kRos1)});
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    const auto reader = io::openRos1Bag({file.string(), "", "", ""});
    while (reader->next()) continue;
    const auto samples = reader->takeOdometry();
    ASSERT_EQ(samples.size(), 6U);
    ASSERT_TRUE(samples[0].sensorPose);
    EXPECT_TRUE(samples[0].sensorPose->translation().isApprox(Eigen::Vector3d(3, 0, 0.5)));
}

TEST(OdometrySamples, OfARawlogComeBack) {
    const test::TemporaryFolder folder;
    constexpr double kEpoch_s = 1317042145.5;
    const Eigen::Isometry3d flat = isometry(rotationExp({0, 0, 0.3}), {1, 2, 0}),
                            full = isometry(rotationExp({0.1, 0.2, 0.3}), {1, 2, 3});
    for (const bool isFlat : {true, false}) {
        OdometrySample written;
        written.pose = isFlat ? flat : full;
        if (!isFlat) written.sensorPose = full;
        io::RawlogWriter writer(folder / "out.rawlog", "lidar", true, true);
        for (int i = 0; i < 20; ++i) {
            written.stamp_s = 0.01 * i;
            writer.add(written, kEpoch_s);
            if (i == 5) writer.add(0.05, kEpoch_s, {1, 2, 3, 0});
        }
        io::DriveMeta meta;
        meta.epoch_s = kEpoch_s;
        writer.finish(meta, "", "", "");
        const auto reader = io::openScans(folder / "out.rawlog");
        ASSERT_TRUE(reader->next());
        EXPECT_FALSE(reader->next());
        const auto samples = reader->takeOdometry();
        ASSERT_EQ(samples.size(), 20U);
        EXPECT_EQ(reader->recording().odometry, "'odometry'");
        EXPECT_NEAR(samples[7].stamp_s, 0.07, 1e-6);
        EXPECT_TRUE(samples[7].pose.isApprox(written.pose, 1e-9));
        EXPECT_EQ(samples[7].sensorPose.has_value(), !isFlat);
    }
}

/** A rawlog of actions and sensory frames. `method`: how the actions were estimated. */
std::string rawlogOfActions(const std::string& path,
                            mrpt::obs::CActionRobotMovement2D::TEstimationMethod method) {
    mrpt::io::CFileOutputStream file(path);
    auto out = mrpt::serialization::archiveFrom(file);
    for (int i = 0; i < 4; ++i) {
        mrpt::obs::CActionCollection actions;
        mrpt::obs::CActionRobotMovement2D moved;
        moved.computeFromOdometry(mrpt::poses::CPose2D(0.5, 0, 0), {});
        moved.estimationMethod = method;
        actions.insert(moved);
        out << actions;
        auto scan = mrpt::obs::CObservationPointCloud::Create();
        scan->sensorLabel = "lidar";
        scan->timestamp = mrpt::Clock::fromDouble(1000 + 0.1 * i);
        scan->pointcloud = mrpt::maps::CSimplePointsMap::Create();
        scan->pointcloud->insertPoint(1, 2, 3);
        mrpt::obs::CSensoryFrame frame;
        frame.insert(scan);
        out << frame;
    }
    return path;
}

TEST(OdometrySamples, OfActionsEndAtTheFrameAfterThem) {
    using Movement = mrpt::obs::CActionRobotMovement2D;
    const test::TemporaryFolder folder;
    const auto reader =
        io::openScans(rawlogOfActions(folder / "wheels.rawlog", Movement::emOdometry));
    while (reader->next()) continue;
    const auto samples = reader->takeOdometry();
    ASSERT_EQ(samples.size(), 4U);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_NEAR(samples[i].stamp_s, 1000 + 0.1 * static_cast<double>(i), 1e-6);
        EXPECT_NEAR(samples[i].pose.translation().x(), 0.5 * static_cast<double>(i + 1), 1e-9);
    }
    EXPECT_EQ(reader->recording().odometry, "actions");
    const auto other =
        io::openScans(rawlogOfActions(folder / "matched.rawlog", Movement::emScan2DMatching));
    while (other->next()) continue;
    EXPECT_TRUE(other->takeOdometry().empty());
}
}  // namespace
}  // namespace delio::bag_test
