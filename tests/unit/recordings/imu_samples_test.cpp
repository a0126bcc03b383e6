#include <algorithm>
#include <cmath>
#include <limits>

#include "bag_files.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/odometry/imu.h"
#include "delio/recordings/scan_reader.h"
#include "recordings/static_transforms.h"

namespace delio::bag_test {
namespace {
/** sensor_msgs/Imu with a rate of (stamp - kBegin_s, 2, 3) rad/s. */
std::string imuMessage(double stamp_s, Kind kind, bool hasRate = true) {
    test::WireWriter message(kind);
    message.header(stamp_s, "imu");
    const auto put = [&](std::initializer_list<double> values) {
        for (const double value : values) message.real(value);
    };
    const auto covariance = [&](double first) { put({first, 0, 0, 0, 0, 0, 0, 0, 0}); };
    put({0, 0, 0, 1});
    covariance(-1);
    put({stamp_s - kBegin_s, 2, 3});
    covariance(hasRate ? 0 : -1);
    put({0.1, 0.2, 9.8});
    covariance(0);
    return message.message();
}

BagContents driveWithImu(int scans, Kind kind) {
    BagContents bag = drive(scans, kind);
    bag.topics.push_back(
        {"/far/imu", kind == Kind::kRos1 ? "sensor_msgs/Imu" : "sensor_msgs/msg/Imu"});
    bag.topics.push_back({"/points_imu", bag.topics.back().type});
    BagContents all = bag;
    all.messages.clear();
    for (std::size_t i = 0; i < bag.messages.size(); ++i) {
        const double at_s = kBegin_s + 0.05 * static_cast<double>(i);
        all.messages.push_back({2, at_s, imuMessage(at_s + 100, kind)});
        all.messages.push_back({3, at_s, imuMessage(at_s, kind)});
        all.messages.push_back(bag.messages[i]);
    }
    return all;
}

TEST(ImuSamples, OfABagAreThoseOfTheNearestTopic) {
    for (const Container& container : containers()) {
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, driveWithImu(6, container.kind));
        const auto reader = container.open({file.string(), "", "", ""});
        EXPECT_EQ(reader->recording().imu, "/points_imu") << container.name;
        std::vector<ImuSample> samples;
        for (std::size_t i = 0; i < 6; ++i) {
            if (i == 2) {  // samples of a skipped scan are not lost
                ASSERT_TRUE(reader->skip());
                continue;
            }
            const auto scan = reader->next();
            ASSERT_TRUE(scan) << container.name;
            expectScan(*scan, i);
            for (const auto& sample : reader->takeImu()) samples.push_back(sample);
        }
        EXPECT_FALSE(reader->next());
        for (const auto& sample : reader->takeImu()) samples.push_back(sample);
        ASSERT_EQ(samples.size(), 12U) << container.name;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double since_s = 0.05 * static_cast<double>(i);
            EXPECT_NEAR(samples[i].stamp_s, kBegin_s + since_s, 1e-6);
            EXPECT_NEAR(samples[i].rate_radps.x(), since_s, 1e-6);
            EXPECT_EQ(samples[i].rate_radps.tail<2>(), Eigen::Vector2d(2, 3));
            EXPECT_EQ(samples[i].acceleration_mps2, Eigen::Vector3d(0.1, 0.2, 9.8));
            EXPECT_FALSE(samples[i].sensorPose);
        }
    }
}

TEST(ImuSamples, OfABagHaveThePoseInTfStatic) {
    for (const Container& container : containers()) {
        BagContents bag = driveWithImu(3, container.kind);
        bag.topics.push_back({"/tf_static", container.kind == Kind::kRos1
                                                ? "tf2_msgs/TFMessage"
                                                : "tf2_msgs/msg/TFMessage"});
        const auto message =
            transformsMessage({{"/velodyne", {1, 0, 2}}, {"imu", {1, 3, 2.5}}}, container.kind);
        bag.messages.push_back({4, kBegin_s + 1, message});
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, bag);
        const auto reader = container.open({file.string(), "", "", ""});
        while (reader->next()) continue;
        const auto samples = reader->takeImu();
        ASSERT_EQ(samples.size(), 6U) << container.name;
        // The LiDAR's x axis is the vehicle's y axis.
        ASSERT_TRUE(samples[0].sensorPose) << container.name;
        EXPECT_TRUE(samples[0].sensorPose->translation().isApprox(Eigen::Vector3d(3, 0, 0.5)));
        EXPECT_TRUE(samples[0].sensorPose->linear().isIdentity(1e-9));
    }
}

TEST(StaticTransforms, ConnectFramesThroughTheirTree) {
    io::StaticTransforms transforms;
    const auto shifted = [](double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); };
    transforms.add("base", "mast", shifted(1));
    transforms.add("mast", "/lidar", shifted(10));
    transforms.add("/base", "imu", shifted(100));
    transforms.add("one", "other", shifted(1));
    transforms.add("other", "one", shifted(1));
    ASSERT_TRUE(transforms.pose("imu", "lidar"));
    EXPECT_EQ(transforms.pose("imu", "lidar")->translation().x(), 89);
    EXPECT_EQ(transforms.pose("/lidar", "base")->translation().x(), 11);
    EXPECT_TRUE(transforms.pose("alone", "alone"));
    EXPECT_FALSE(transforms.pose("imu", "other"));
    EXPECT_FALSE(transforms.pose("one", "base"));
}

TEST(ImuSamples, BrokenMessagesAreLeftOut) {
    BagContents bag = drive(3);
    bag.topics.push_back({"/imu", "sensor_msgs/Imu"});
    bag.messages.push_back({2, kBegin_s, imuMessage(kBegin_s, Kind::kRos1).substr(0, 100)});
    bag.messages.push_back({2, kBegin_s + 0.1, imuMessage(0, Kind::kRos1)});
    bag.messages.push_back({2, kBegin_s + 0.2, imuMessage(kBegin_s + 0.2, Kind::kRos1, false)});
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    const auto reader = io::openRos1Bag({file.string(), "", "", ""});
    while (reader->next()) continue;
    const auto samples = reader->takeImu();
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_NEAR(samples[0].stamp_s, kBegin_s + 0.1, 1e-6);  // when it was recorded
    EXPECT_TRUE(std::isnan(samples[1].rate_radps.x()));
    EXPECT_EQ(samples[1].acceleration_mps2.z(), 9.8);
}

TEST(ImuSamples, OfARawlogComeBack) {
    const test::TemporaryFolder folder;
    constexpr double kEpoch_s = 1317042145.5;
    io::RawlogWriter writer(folder / "out.rawlog", "lidar", true, false);
    ImuSample written;
    written.rate_radps = Eigen::Vector3d(0.1, -0.2, 0.3);
    Eigen::Isometry3d pose(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
    pose.translation() = Eigen::Vector3d(1, 2, 3);
    written.sensorPose = pose;
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
    const auto samples = reader->takeImu();
    ASSERT_EQ(samples.size(), 20U);
    EXPECT_EQ(reader->recording().imu, "'imu'");
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_NEAR(samples[i].stamp_s, 0.01 * static_cast<double>(i), 1e-6);
        EXPECT_EQ(samples[i].rate_radps, written.rate_radps);
        EXPECT_FALSE(samples[i].acceleration_mps2.allFinite());
        ASSERT_TRUE(samples[i].sensorPose);
        EXPECT_TRUE(samples[i].sensorPose->isApprox(pose, 1e-9));
    }
}

/** A folder of scans, 0.1 s apart, and imu.csv. */
struct Folder {
    test::TemporaryFolder folder;

    explicit Folder(const std::string& imu, double begin_s = 0) {
        std::string times;
        for (int i = 0; i < 30; ++i) {
            std::string points;
            for (int k = 0; k < 20; ++k) points += std::to_string(k) + " 2 3\n";
            test::writeText(folder / (std::to_string(100 + i) + ".txt"), points);
            times += std::to_string(begin_s + 0.1 * i) + "\n";
        }
        test::writeText(folder / "times.txt", times);
        test::writeText(folder / "imu.csv", imu);
    }
};

TEST(ImuSamples, BesideAFolderOfScansComeWithThem) {
    std::string rows = "stamp,wx,wy,wz,ax,ay,az\n";
    for (int i = 0; i < 400; ++i)
        rows += std::to_string(0.01 * i) + ",0.1,0.2,0.3" + (i < 200 ? ",1,2,3\n" : "\n");
    const Folder drive(rows);
    const auto reader = io::openScans(drive.folder.path().string());
    EXPECT_EQ(reader->recording().imu, "imu.csv");
    std::size_t taken = 0;
    std::vector<ImuSample> samples;
    for (std::size_t i = 0; const auto scan = reader->next(); ++i) {
        for (const auto& sample : reader->takeImu()) samples.push_back(sample);
        if (i == 0) taken = samples.size();
        // Whatever a scan needs has come with it.
        EXPECT_GE(samples.back().stamp_s, std::min(scan->stamp_s + 0.3, 3.99));
    }
    EXPECT_LT(taken, 200U);  // not all at once
    ASSERT_EQ(samples.size(), 400U);
    EXPECT_EQ(samples[7].rate_radps, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(samples[7].acceleration_mps2, Eigen::Vector3d(1, 2, 3));
    EXPECT_FALSE(samples[300].acceleration_mps2.allFinite());
}

TEST(ImuSamples, BesideAFolderMayHaveUnixNanoseconds) {
    const Folder drive("#timestamp [ns],w\n1700000000250000000,1,2,3\n1700000000100000000,1,2,3\n",
                       1.7e9);
    const auto reader = io::openScans(drive.folder.path().string());
    ASSERT_TRUE(reader->next());
    const auto samples = reader->takeImu();
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_NEAR(samples[0].stamp_s, 1700000000.1, 1e-6);
    EXPECT_NEAR(samples[1].stamp_s, 1700000000.25, 1e-6);
}

TEST(ImuSamples, ABrokenTableIsAnErrorWithItsLine) {
    for (const char* rows :
         {"0,1,2\n", "0,1,2,3\n0.1,1,2,3,4\n", "0,1,2,3\nwords\n", "nan,1,2,3\n"}) {
        const Folder drive(rows);
        try {
            io::openScans(drive.folder.path().string());
            FAIL() << rows;
        } catch (const Error& e) {
            expectHolds(e.what(), {"imu.csv", "line "});
        }
    }
}
}  // namespace
}  // namespace delio::bag_test
