// Messages with packets of Hesai and RoboSense sensors.
#include "recordings/packet_messages.h"

#include "bag_files.h"
#include "recordings/packet_decoder.h"
#include "recordings/scan_maker.h"
#include "spinning_packets.h"

namespace delio::bag_test {
namespace {
using test::Bytes;
using test::TimedPacket;
using test::WireWriter;

std::string textOf(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

/** Writes packets as one message of a type. */
using Write = std::function<std::string(const std::vector<TimedPacket>&, Kind)>;

std::string withRoom(const std::vector<TimedPacket>& packets, Kind kind, std::size_t room,
                     bool hasSize) {
    WireWriter out(kind);
    out.header(packets[0].time_s).number(static_cast<std::uint32_t>(packets.size()));
    for (const TimedPacket& packet : packets) {
        std::string text = textOf(packet.bytes);
        text.resize(room);
        out.time(packet.time_s).bytes(text);
        if (hasSize) out.number(static_cast<std::uint32_t>(packet.bytes.size()));
    }
    return out.message();
}

std::string udpFrame(const std::vector<TimedPacket>& packets, Kind kind, bool hasHeader) {
    WireWriter out(kind);
    if (hasHeader) out.header(packets[0].time_s);
    out.number(static_cast<std::uint32_t>(packets.size()));
    for (const TimedPacket& packet : packets)
        out.byteArray(textOf(packet.bytes)).number(static_cast<std::uint32_t>(packet.bytes.size()));
    return out.message();
}

std::string nebulaPackets(const std::vector<TimedPacket>& packets, Kind kind) {
    WireWriter out(kind);
    out.header(packets[0].time_s).number(static_cast<std::uint32_t>(packets.size()));
    for (const TimedPacket& packet : packets)
        out.time(packet.time_s).byteArray(textOf(packet.bytes));
    return out.message();
}

std::string onePacket(const TimedPacket& packet, Kind kind) {
    WireWriter out(kind);
    out.header(packet.time_s).number(std::uint8_t{0}).number(std::uint8_t{0});
    return out.byteArray(textOf(packet.bytes)).message();
}

struct Form {
    const char* type;
    bool isHesai;
    Write write;
};

std::vector<Form> forms() {
    return {{"pandar_msgs/msg/PandarScan", true,
             [](const auto& p, Kind k) { return withRoom(p, k, 1500, true); }},
            {"nebula_msgs/msg/NebulaPackets", true, nebulaPackets},
            {"nebula_msgs/msg/NebulaPackets", false, nebulaPackets},
            {"hesai_ros_driver/msg/UdpFrame", true,
             [](const auto& p, Kind k) { return udpFrame(p, k, true); }},
            {"hesai_ros_driver/msg/UdpFrame", true,
             [](const auto& p, Kind k) { return udpFrame(p, k, false); }},
            {"robosense_msgs/msg/RobosenseScan", false,
             [](const auto& p, Kind k) { return withRoom(p, k, 1248, false); }},
            {"rslidar_msgs/msg/rslidarScan", false,
             [](const auto& p, Kind k) { return withRoom(p, k, 1248, false); }},
            {"rslidar_msg/msg/RslidarPacket", false,
             [](const auto& p, Kind k) { return onePacket(p[0], k); }}};
}

/** The drive of a sensor in messages of `perMessage` packets; a RoboSense's description lies in a
 *  topic of its own. */
BagContents bagOf(const Form& form, Kind kind) {
    const auto toy = test::robosenseToys()[0];
    const auto packets =
        form.isHesai ? test::hesaiDrive(test::hesaiToys()[3], 2.2) : test::robosenseDrive(toy, 2.2);
    std::string type = form.type;
    if (kind == Kind::kRos1) type = io::plainType(type);
    BagContents bag;
    bag.encoding = kind == Kind::kRos1 ? "ros1" : "cdr";
    bag.topics = {{"/lidar/packets", type},
                  {"/lidar/info", kind == Kind::kRos1 ? "robosense_msgs/RobosenseInfoPacket"
                                                      : "robosense_msgs/msg/RobosenseInfoPacket"}};
    const std::size_t perMessage = type.find("RslidarPacket") == std::string::npos ? 50 : 1;
    for (std::size_t i = 0; i < packets.size(); i += perMessage) {
        const std::size_t end = std::min(packets.size(), i + perMessage);
        const std::vector<TimedPacket> part(packets.begin() + static_cast<std::ptrdiff_t>(i),
                                            packets.begin() + static_cast<std::ptrdiff_t>(end));
        bag.messages.push_back({0, part.back().time_s + 0.01, form.write(part, kind)});
    }
    if (!form.isHesai) {
        WireWriter out(kind);
        out.text("Helios").time(packets[0].time_s);
        bag.messages.push_back(
            {1, packets[0].time_s, out.bytes(textOf(test::robosenseDescription(toy))).message()});
    }
    return bag;
}
}  // namespace

TEST(PacketMessages, OfEveryTypeAndContainer) {
    const test::TemporaryFolder folder;
    for (const Form& form : forms())
        for (const Container& container : containers()) {
            if (container.name == std::string("bag, bz2")) continue;  // slow
            SCOPED_TRACE(std::string(form.type) + " in " + container.name);
            const std::string file = folder / container.file;
            container.write(file, bagOf(form, container.kind));
            io::ScanSource source;
            source.path = file;
            const auto reader = container.open(source);
            std::vector<std::size_t> sizes;
            while (const auto scan = reader->next()) sizes.push_back(scan->points->size());
            EXPECT_EQ(sizes, std::vector<std::size_t>(2, 1800U * 32));
            EXPECT_EQ(reader->recording().sensor,
                      form.isHesai ? "Hesai PandarXT-32" : "RoboSense Helios");
            EXPECT_EQ(reader->recording().motionCompensated, false);
            std::filesystem::remove_all(file);
        }
}

TEST(PacketMessages, ThatAreCutOffAreRefused) {
    for (const Form& form : forms()) {
        const auto packets = test::hesaiDrive(test::hesaiToys()[2], 0.02);
        const std::string whole = form.write({packets.begin(), packets.begin() + 3}, Kind::kRos1);
        for (std::size_t size = 0; size < whole.size(); size += 13) {
            const io::Message message{"/p",
                                      form.type,
                                      io::Encoding::kRos1,
                                      0,
                                      {reinterpret_cast<const std::uint8_t*>(whole.data()), size}};
            EXPECT_THROW(io::packetsIn(message, form.type), Error) << form.type << " " << size;
        }
    }
}

TEST(PacketMessages, ClaimMoreThanTheyHave) {
    auto packets = test::hesaiDrive(test::hesaiToys()[2], 0.02);
    std::string message = withRoom({packets[0]}, Kind::kRos1, 1500, true);
    message.back() = '\x7f';
    EXPECT_THROW(
        io::packetsIn({"/p",
                       "pandar_msgs/PandarScan",
                       io::Encoding::kRos1,
                       0,
                       {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}},
                      "pandar_msgs/PandarScan"),
        Error);
}

TEST(PacketMessages, OfUnknownSensorsSaySo) {
    const auto maker = io::makePacketMaker(io::ScanType::kPackets, io::recognisingDecoder(""));
    const std::string message = nebulaPackets({{Bytes(700), kBegin_s}}, Kind::kRos1);
    maker->add({"/p",
                "nebula_msgs/NebulaPackets",
                io::Encoding::kRos1,
                0,
                {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}},
               0);
    try {
        maker->finish();
        ADD_FAILURE();
    } catch (const Error& e) {
        expectHolds(e.what(), {"packets of 700 bytes are of no LiDAR that is supported"});
    }
}
}  // namespace delio::bag_test
