#include "bag_files.h"
#include "ouster_packets.h"

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

    expectHolds(faultWith(bag, "points"),
                {"several topics that match 'points'", "/points", "/rear/points"});
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
                {"no topic with LiDAR scans", "sensor_msgs/LaserScan", "std_msgs/String"});
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
    expectHolds(faultWith(bag, ""), {"--sensor-info", ".json"});
    bag.messages.push_back({2, kBegin_s, plainText("no json")});
    const std::string fault = faultWith(bag, "");
    EXPECT_NE(fault, "");
    EXPECT_EQ(fault.find("is not there"), std::string::npos) << fault;
}

TEST(BagTopics, EachOusterHasItsOwnDescription) {
    test::OusterToy left, right;
    left.serial = 5;
    right.serial = 6;
    BagContents bag;
    bag.topics = {{"/left/metadata", "std_msgs/String"},
                  {"/right/metadata", "std_msgs/String"},
                  {"/right/lidar_packets", "ouster_ros/PacketMsg"}};
    bag.messages = {{0, kBegin_s, plainText(left.json().dump())},
                    {1, kBegin_s, plainText(right.json().dump())}};
    for (std::size_t i = 0; i < 32; ++i) {
        const test::Bytes packet = right.packet(0, i);
        const std::string bytes(packet.begin(), packet.end());
        bag.messages.push_back(
            {2, kBegin_s, test::WireWriter(Kind::kRos1).byteArray(bytes).message()});
    }
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    io::ScanSource source{file.string(), "", "", ""};
    EXPECT_TRUE(io::openRos1Bag(source)->next());
    source.sensorFile = (folder / "left.json").string();
    test::writeText(source.sensorFile, left.json().dump());
    expectHolds(readAll(io::openRos1Bag, source).fault,
                {"d.bag", "serial number 5", "serial number 6"});
}
}  // namespace delio::bag_test
