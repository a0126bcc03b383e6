#include <cmath>

#include "bag_files.h"
#include "recordings/scan_maker.h"

namespace delio::bag_test {
namespace {
io::Message messageOf(const std::string& bytes, Kind kind, double log_s = 0) {
    const auto encoding = kind == Kind::kRos1 ? io::Encoding::kRos1 : io::Encoding::kCdr;
    return {"/points",
            "",
            encoding,
            log_s,
            {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}};
}

Scan scanOf(const std::string& bytes, Kind kind, double log_s = 0) {
    const auto maker = io::makeCloudMaker();
    maker->add(messageOf(bytes, kind, log_s), 0);
    auto scan = maker->take();
    if (!scan) throw Error("no scan");
    EXPECT_FALSE(maker->take());
    return std::move(*scan);
}

constexpr Kind kKinds[] = {Kind::kRos1, Kind::kCdr, Kind::kCdrBigEndian};

/** Notes what it is given; a scan of every three packets. */
class Notes : public io::PacketDecoder {
 public:
    explicit Notes(std::vector<double>& times) : times_(times) {}
    bool takes(std::size_t bytes) const override { return bytes == 1206; }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override {
        EXPECT_EQ(bytes, 1206U);
        EXPECT_EQ(payload[0], payload[1205]);
        times_.push_back(received_s);
        return true;
    }
    void finish() override { finished_ = true; }
    std::optional<Scan> take() override {
        if (times_.size() < taken_ + (finished_ ? 1 : 3)) return std::nullopt;
        taken_ = std::min(taken_ + 3, times_.size());
        return Scan{};
    }
    std::string sensor() const override { return "Maker MODEL-1"; }

 private:
    std::vector<double>& times_;
    std::size_t taken_ = 0;
    bool finished_ = false;
};

std::string velodyneMessage(Kind kind, const std::vector<double>& times) {
    test::WireWriter out(kind);
    out.header(3).number(static_cast<std::uint32_t>(times.size()));
    for (std::size_t i = 0; i < times.size(); ++i)
        out.time(times[i]).bytes(std::string(1206, static_cast<char>(i)));
    return out.message();
}
}  // namespace

TEST(BagMessages, CloudsOfEveryEncoding) {
    for (const Kind kind : kKinds)
        for (const bool bigEndian : {false, true})
            for (const std::uint32_t rows : {1U, 4U}) {
                CloudSpec cloud;
                cloud.stamp_s = kBegin_s;
                cloud.bigEndian = bigEndian;
                cloud.rows = rows;
                for (const std::uint32_t padding : {0U, 5U, 64U}) {
                    cloud.padding = padding;
                    expectScan(scanOf(cloudMessage(cloud, kind), kind), 0, 20 * rows);
                }
            }
}

TEST(BagMessages, ZeroStampIsTheTimeOfRecording) {
    const Scan scan = scanOf(test::cloudMessage({}), Kind::kRos1, 1234.5);
    EXPECT_EQ(scan.stamp_s, 1234.5);
    EXPECT_EQ(mrpt::Clock::toDouble(scan.time), 1234.5);
}

TEST(BagMessages, TwoFramesAreTwoSensors) {
    CloudSpec left, right;
    left.frame = "left";
    right.frame = "right";
    const auto toLeft = cloudMessage(left), toRight = cloudMessage(right);
    const auto all = io::makeCloudMaker("/points");
    all->add(messageOf(toLeft, Kind::kRos1), 0);
    EXPECT_TRUE(all->take());
    try {
        all->add(messageOf(toRight, Kind::kRos1), 1);
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("/points:left, /points:right"), std::string::npos)
            << e.what();
    }
    const auto one = io::makeCloudMaker("/points", "right");
    one->add(messageOf(toLeft, Kind::kRos1), 0);
    EXPECT_FALSE(one->take());
    one->add(messageOf(toRight, Kind::kRos1), 0);
    EXPECT_TRUE(one->take());
}

TEST(BagMessages, CloudWithoutPointsIsAScan) {
    CloudSpec cloud;
    cloud.columns = 0;
    EXPECT_EQ(scanOf(cloudMessage(cloud), Kind::kRos1).points->size(), 0U);
}

TEST(BagMessages, CutOffAnywhereIsAnError) {
    for (const Kind kind : kKinds) {
        const std::string whole = cloudMessage(CloudSpec{}, kind);
        for (std::size_t bytes = 0; bytes < whole.size(); ++bytes)
            EXPECT_THROW(scanOf(whole.substr(0, bytes), kind), Error) << bytes;
    }
}

TEST(BagMessages, SizesBeyondTheMessageAreErrors) {
    CloudSpec cloud;
    cloud.rows = 4;
    const std::string whole = cloudMessage(cloud);
    // Height, width, number of fields; step, row step and length of the points' bytes.
    const std::size_t tail = whole.size() - 1 - std::size_t{4} * 20 * 24;
    for (const std::size_t at : {24, 28, 32, 36}) {
        std::string lie = whole;
        lie[at + 3] = '\x7f';
        EXPECT_THROW(scanOf(lie, Kind::kRos1), Error) << at;
    }
    for (const std::size_t back : {12, 8, 4}) {
        std::string lie = whole;
        lie[tail - back + 3] = '\x7f';
        EXPECT_THROW(scanOf(lie, Kind::kRos1), Error) << back;
    }
    std::string noStep = whole;
    noStep[tail - 12] = 0;
    EXPECT_THROW(scanOf(noStep, Kind::kRos1), Error);
}

TEST(BagMessages, FaultNamesFileAndScan) {
    BagContents bag = drive(3);
    CloudSpec cloud;
    cloud.withX = false;
    bag.messages[4].bytes = cloudMessage(cloud);
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, bag);
    const Outcome outcome = readAll(io::openRos1Bag, {file.string(), "", "", ""});
    EXPECT_EQ(outcome.scans, 2U);
    expectHolds(outcome.fault, {"scan 2 of", "d.bag", "/points"});
}

TEST(BagMessages, ForeignEncodingIsAnError) {
    BagContents bag = drive(3);
    bag.encoding = "json";
    const test::TemporaryFolder folder;
    const auto file = folder / "d.mcap";
    writeMcap(file, bag);
    expectHolds(faultOf(io::openMcap, {file.string(), "", "", ""}), {"ROS 1", "CDR"});
    EXPECT_THROW(scanOf(std::string("\1\2\3\4", 4), Kind::kCdr), Error);
}

TEST(BagMessages, PacketsAreAStream) {
    for (const Kind kind : kKinds) {
        std::vector<double> times;
        const auto maker =
            io::makePacketMaker(io::ScanType::kVelodyne, std::make_unique<Notes>(times));
        maker->add(messageOf(velodyneMessage(kind, {1, 1.5}), kind), 0);
        EXPECT_FALSE(maker->take());
        maker->add(messageOf(velodyneMessage(kind, {2, 0}), kind, 2.5), 0);
        EXPECT_TRUE(maker->take());
        EXPECT_FALSE(maker->take());
        maker->finish();
        EXPECT_TRUE(maker->take());
        EXPECT_FALSE(maker->take());
        EXPECT_EQ(times, (std::vector<double>{1, 1.5, 2, 2.5}));
        const std::string whole = velodyneMessage(kind, {1, 2});
        for (std::size_t bytes = 0; bytes < whole.size(); bytes += 13)
            EXPECT_THROW(maker->add(messageOf(whole.substr(0, bytes), kind), 0), Error) << bytes;
    }
}

TEST(BagMessages, OusterPackets) {
    for (const Kind kind : kKinds) {
        std::vector<double> times;
        const auto maker =
            io::makePacketMaker(io::ScanType::kOuster, std::make_unique<Notes>(times));
        const auto message = [&](std::size_t size) {
            return test::WireWriter(kind).byteArray(std::string(size, 'p')).message();
        };
        maker->add(messageOf(message(1206), kind, 7), 0);
        maker->add(messageOf(message(48), kind, 8), 0);  // of its IMU
        EXPECT_EQ(times, std::vector<double>{7});
        maker->finish();
        const auto ofOther =
            io::makePacketMaker(io::ScanType::kOuster, std::make_unique<Notes>(times));
        ofOther->add(messageOf(message(6464), kind, 7), 0);
        EXPECT_THROW(ofOther->finish(), Error);
        std::string lie = message(1206);
        lie.resize(100);
        EXPECT_THROW(maker->add(messageOf(lie, kind), 0), Error);
    }
}

TEST(BagMessages, TypesOfScans) {
    const auto type = [](const std::string& name, const std::string& of) {
        return io::scanTypeOf({name, of, std::nullopt});
    };
    EXPECT_EQ(type("/p", "sensor_msgs/PointCloud2"), io::ScanType::kCloud);
    EXPECT_EQ(type("/p", "sensor_msgs/msg/PointCloud2"), io::ScanType::kCloud);
    EXPECT_EQ(type("/p", "velodyne_msgs/msg/VelodyneScan"), io::ScanType::kVelodyne);
    for (const std::string package : {"ouster_ros", "ouster_msgs", "ouster_sensor_msgs"}) {
        EXPECT_EQ(type("/os/lidar_packets", package + "/PacketMsg"), io::ScanType::kOuster);
        EXPECT_EQ(type("/os/lidar_packets", package + "/msg/PacketMsg"), io::ScanType::kOuster);
        EXPECT_EQ(type("/os/imu_packets", package + "/PacketMsg"), io::ScanType::kNone);
    }
    EXPECT_EQ(type("/p", "sensor_msgs/PointCloud"), io::ScanType::kNone);
    EXPECT_EQ(type("/p", "foxglove.PointCloud"), io::ScanType::kNone);
}
}  // namespace delio::bag_test
