#include "bag_files.h"

namespace delio::bag_test {
namespace {
std::string faultWith(const BagContents& bag, const std::string& label) {
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    return faultOf(io::openRos1Bag, {file.string(), label, "", ""});
}
}  // namespace

TEST(BagTopics, OfSeveralOneHasToBeChosen) {
    BagContents bag = drive(2);
    bag.topics.push_back({"/rear/points", "sensor_msgs/PointCloud2"});
    for (int i = 0; i < 2; ++i) {
        CloudSpec cloud;
        cloud.columns = 9;
        cloud.scan = i;
        cloud.stamp_s = kBegin_s + 0.1 * i;
        bag.messages.push_back({2, cloud.stamp_s, cloudMessage(cloud)});
    }
    expectHolds(faultWith(bag, ""),
                {"/points (sensor_msgs/PointCloud2)", "/rear/points", "--sensor-label"});
    EXPECT_EQ(faultWith(bag, "").find("/chatter"), std::string::npos);
    expectHolds(faultWith(bag, "/front"), {"'/front'", "/points", "/rear/points"});
    expectHolds(faultWith(bag, "/chatter"), {"'/chatter'", "/points", "/rear/points"});

    expectHolds(faultWith(bag, "points"), {"several topics 'points'", "/points", "/rear/points"});
    expectHolds(faultWith(bag, "ear/points"), {"no scans of the topic 'ear/points'"});

    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    for (const char* label : {"/rear/points", "rear/points"}) {
        const auto reader = io::openRos1Bag({file.string(), label, "", ""});
        EXPECT_EQ(reader->label(), "/rear/points");
        EXPECT_TRUE(reader->otherLabels().empty());
        const auto scan = reader->next();
        ASSERT_TRUE(scan);
        expectScan(*scan, 0, 9);
    }
}

TEST(BagTopics, CloudsAndPacketsAreSeveral) {
    BagContents bag = drive(2);
    bag.topics.push_back({"/packets", "velodyne_msgs/VelodyneScan"});
    bag.messages.push_back(
        {2, kBegin_s, test::WireWriter(Kind::kRos1).header(1).number(0U).message()});
    expectHolds(faultWith(bag, ""), {"/points", "/packets (velodyne_msgs/VelodyneScan)"});
}

TEST(BagTopics, WithoutScansTheTypesAreNamed) {
    BagContents bag = drive(2);
    bag.topics[0] = {"/scan", "sensor_msgs/LaserScan"};
    expectHolds(faultWith(bag, ""),
                {"no topic with scans", "sensor_msgs/LaserScan", "std_msgs/String"});
}

TEST(BagTopics, SeveralConnectionsAreOneTopic) {
    BagContents bag = drive(4);
    bag.topics.push_back(bag.topics[0]);
    bag.messages[2].topic = 2;
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    const io::ScanSource source{file.string(), "", "", ""};
    EXPECT_EQ(io::openRos1Bag(source)->recording().scans, 4U);
    EXPECT_EQ(readAll(io::openRos1Bag, source).scans, 4U);
}

TEST(BagTopics, OusterNeedsItsDescription) {
    BagContents bag;
    bag.topics = {{"/os/lidar_packets", "ouster_ros/PacketMsg"},
                  {"/os/imu_packets", "ouster_ros/PacketMsg"},
                  {"/os/metadata", "std_msgs/String"}};
    const std::string packet =
        test::WireWriter(Kind::kRos1).byteArray(std::string(48, 'i')).message();
    bag.messages = {{0, kBegin_s, packet}, {1, kBegin_s, packet}};
    expectHolds(faultWith(bag, ""), {"--sensor", ".json"});
    bag.messages.push_back({2, kBegin_s, plainText("no json")});
    const std::string fault = faultWith(bag, "");
    EXPECT_NE(fault, "");
    EXPECT_EQ(fault.find("lay it beside"), std::string::npos) << fault;
}
}  // namespace delio::bag_test
