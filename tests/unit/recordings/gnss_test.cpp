#include <mrpt/obs/CObservationGPS.h>

#include <cmath>
#include <cstring>

#include "bag_files.h"
#include "delio/core/geometry.h"
#include "rawlog_files.h"
#include "toy_drive.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

mrpt::obs::CObservationGPS::Ptr gps(double stamp_s, int quality) {
    auto observation = mrpt::obs::CObservationGPS::Create();
    observation->sensorLabel = "gps";
    observation->timestamp = mrpt::Clock::fromDouble(stamp_s);
    observation->sensorPose = mrpt::poses::CPose3D(1, 2, 3);
    mrpt::obs::gnss::Message_NMEA_GGA gga;
    gga.fields.latitude_degrees = 49;
    gga.fields.longitude_degrees = 8.4;
    gga.fields.altitude_meters = 100;
    gga.fields.geoidal_distance = 48;
    gga.fields.fix_quality = static_cast<std::uint8_t>(quality);
    gga.fields.thereis_HDOP = true;
    gga.fields.HDOP = 2;
    observation->setMsg(gga);
    return observation;
}

std::vector<float> ring() {
    std::vector<float> xyzi;
    for (int i = 0; i < 400; ++i) {
        const float angle = 0.0157F * static_cast<float>(i);
        for (const float value : {10 * std::cos(angle), 10 * std::sin(angle), 0.5F, 1.0F})
            xyzi.push_back(value);
    }
    return xyzi;
}

TEST(Gnss, OfARawlogComesWithTheScans) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "d.rawlog";
    rawlog_test::writeRawlog(
        file, {gps(999.95, 4), rawlog_test::cloudObservation(0), gps(1000.05, 1),
               rawlog_test::cloudObservation(1), gps(1000.15, 0),
               mrpt::obs::CObservationGPS::Create(), rawlog_test::cloudObservation(2)});
    rawlog_test::writeEpoch(file, 900);
    const auto reader = io::openScans(file);
    while (reader->next()) continue;
    const auto fixes = reader->takeFixes();
    ASSERT_EQ(fixes.size(), 2U);  // without a fix there is none
    EXPECT_NEAR(fixes[0].stamp_s, 99.95, 1e-6);
    EXPECT_EQ(fixes[0].place.latitude_deg, 49);
    EXPECT_EQ(fixes[0].place.height_m, 148);  // above the ellipsoid
    EXPECT_NEAR(fixes[0].covariance(0, 0), 0.04 * 0.04, 1e-9);
    EXPECT_NEAR(fixes[1].covariance(0, 0), 36, 1e-9);
    EXPECT_EQ(*fixes[0].antenna, Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(reader->takeFixes().empty());
    EXPECT_TRUE(reader->otherLabels().empty());
}

test::BagBytes navSatFix(double stamp_s, int status, double height, test::WireWriter::Kind kind) {
    const auto bits = [](double value) {
        std::uint64_t number = 0;
        std::memcpy(&number, &value, sizeof(number));
        return number;
    };
    test::WireWriter message(kind);
    message.header(stamp_s, "gps").number(static_cast<std::uint8_t>(status));
    message.number(std::uint16_t{1}).number(bits(49)).number(bits(8.4)).number(bits(height));
    for (const double value : {4.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 16.0})
        message.number(bits(value));
    message.number(std::uint8_t{2});
    return message.message();
}

TEST(Gnss, OfABagIsNavSatFix) {
    const test::TemporaryFolder folder;
    for (const bool ros2 : {false, true}) {
        const auto kind = ros2 ? test::WireWriter::Kind::kCdr : test::WireWriter::Kind::kRos1;
        test::BagContents bag;
        bag.encoding = ros2 ? "cdr" : "ros1";
        bag.topics = {{"/points", ros2 ? "sensor_msgs/msg/PointCloud2" : "sensor_msgs/PointCloud2"},
                      {"/fix", ros2 ? "sensor_msgs/msg/NavSatFix" : "sensor_msgs/NavSatFix"}};
        if (ros2) {
            bag.topics.push_back({"/tf_static", "tf2_msgs/msg/TFMessage"});
            const auto poses = {std::make_pair("gps", Eigen::Vector3d(0, 1, 3)),
                                std::make_pair("velodyne", Eigen::Vector3d(0, 0, 2))};
            bag.messages.push_back(
                {2, 1e9, test::transformsMessage({poses.begin(), poses.end()}, kind)});
        }
        const auto xyzi = ring();
        for (int i = 0; i < 4; ++i) {
            test::CloudSpec cloud;
            cloud.scan = i;
            cloud.stamp_s = 1e9 + 0.1 * i;
            cloud.xyzi = &xyzi;
            cloud.columns = 400;
            bag.messages.push_back({0, cloud.stamp_s, cloudMessage(cloud, kind)});
            const double height = i == 2 ? std::nan("") : 115;
            bag.messages.push_back(
                {1, cloud.stamp_s + 0.05,
                 navSatFix(cloud.stamp_s + 0.05, i == 3 ? -1 : 0, height, kind)});
        }
        const auto file = folder / (ros2 ? "d.mcap" : "d.bag");
        if (ros2)
            test::writeMcap(file, bag);
        else
            test::writeRos1Bag(file, bag);
        const auto reader = io::openScans(file);
        while (reader->next()) continue;
        const auto fixes = reader->takeFixes();
        ASSERT_EQ(fixes.size(), 3U) << ros2;
        EXPECT_NEAR(fixes[1].stamp_s, 1e9 + 0.15, 1e-6);
        EXPECT_EQ(fixes[1].place.longitude_deg, 8.4);
        EXPECT_EQ(fixes[1].place.height_m, 115);
        EXPECT_EQ(fixes[1].covariance.diagonal(), Eigen::Vector3d(4, 9, 16));
        EXPECT_EQ(fixes[2].covariance(2, 2), 1e6);  // no height
        EXPECT_TRUE(earth::isUsable(fixes[2]));
        EXPECT_EQ(fixes[1].antenna.has_value(), ros2);
        if (ros2) {
            EXPECT_TRUE(fixes[1].antenna->isApprox(Eigen::Vector3d(1, 0, 1)));
        }
        EXPECT_TRUE(reader->takeFixes().empty());
    }
}

TEST(Gnss, LiesBesideScans) {
    const test::TemporaryFolder folder;
    const fs::path scans = folder / "scans";
    fs::create_directories(scans);
    std::string text;
    for (int i = 0; i < 400; ++i)
        text += std::to_string(std::cos(0.0157 * i)) + " " + std::to_string(std::sin(0.0157 * i)) +
                " 1 5\n";
    for (const char* name : {"1.txt", "2.txt", "3.txt"}) test::writeText(scans / name, text);
    const std::string csv = "time,latitude,longitude\n0.05,49,8.4\n";
    for (const fs::path& place : {scans / "gnss.csv", fs::path(folder / "gnss.csv")}) {
        test::writeText(place, csv);
        const auto reader = io::openScans(scans.string());
        std::size_t count = 0;
        while (reader->next()) ++count;
        EXPECT_EQ(count, 3U);
        EXPECT_EQ(reader->takeFixes().size(), 1U) << place;
        fs::remove(place);
    }
    const fs::path kitti = folder / "00";
    test::writeSequence(kitti, test::toyScans(2));
    test::writeText(kitti / "gnss.csv", csv);
    EXPECT_EQ(io::openScans(kitti.string())->takeFixes().size(), 1U);
}
}  // namespace
