// Packets of every maker over loopback, and the recording of them.
#include <gtest/gtest.h>

#include <future>
#include <optional>

#include "delio/core/error.h"
#include "delio/recordings/scan_reader.h"
#include "http_ends.h"
#include "ouster_packets.h"
#include "recordings/live_source.h"
#include "same_scans.h"
#include "spinner.h"
#include "spinning_packets.h"
#include "test_data.h"
#include "udp_sender.h"

namespace {
using namespace delio;
using test::Bytes;

TEST(UdpAddress, IsReadStrictly) {
    const auto any = io::udpAddressIn("udp://2368");
    EXPECT_EQ(any.address, 0U);
    EXPECT_EQ(any.ports, std::vector<std::uint16_t>{2368});
    EXPECT_EQ(io::udpAddressIn("udp://:2368").address, 0U);
    const auto both = io::udpAddressIn("udp://127.0.0.1:6699,7788");
    EXPECT_EQ(both.address, 0x7F000001U);
    EXPECT_EQ(both.ports, (std::vector<std::uint16_t>{6699, 7788}));
    for (const char* const wrong :
         {"udp://", "udp://:", "udp://host:2368", "udp://1.2.3:1", "udp://:0", "udp://:65536",
          "udp://:-1", "udp://:1,", "udp://:,1", "udp://:2368x", "udp://::1:2368"})
        EXPECT_THROW(io::udpAddressIn(wrong), Error) << wrong;
}

/** Scans of packets that are sent to a live reader; its recording is `pcap`. */
struct Drive {
    std::vector<Scan> scans;
    std::set<std::string> others;
    std::optional<io::LiveReport> report;
    std::string fault;
    double sinceLast_s = 0;  //!< from what completed the last scan to its end
};

using Packets = std::vector<std::pair<std::size_t, Bytes>>;  // port, payload

Packets toOnePort(const std::vector<test::TimedPacket>& timed) {
    Packets packets;
    for (const auto& packet : timed) packets.emplace_back(0, packet.bytes);
    return packets;
}

/** The drive ends some time after the last packet: what it gives is the recording's,
 *  however much of the packets came. */
Drive sent(const Packets& packets, const std::string& pcap, const std::string& sensorFile = "",
           std::size_t ports = 1, std::uint16_t sensorHttpPort = 80) {
    std::vector<std::uint16_t> to;
    for (std::size_t i = 0; i < ports; ++i) to.push_back(test::freePort());
    io::ScanSource source;
    source.path = "udp://127.0.0.1:";
    for (std::size_t i = 0; i < ports; ++i)
        source.path += (i > 0 ? "," : "") + std::to_string(to[i]);
    source.sensorFile = sensorFile;
    source.live.record = pcap;
    source.live.sensorHttpPort = sensorHttpPort;
    source.live.idle_s = 3;  // the sender may have to wait on a busy machine
    source.live.mostWaiting = 1000;
    auto drive = std::async(std::launch::async, [&] {
        Drive result;
        try {
            const auto reader = io::openScans(source);
            EXPECT_FALSE(reader->fraction());
            EXPECT_EQ(reader->recording().kind, source.path);
            while (auto scan = reader->next()) {
                EXPECT_TRUE(reader->received_s());
                result.scans.push_back(*scan);
            }
            // The end of the drive completed the last scan, not a packet seconds ago.
            const std::chrono::duration<double> now =
                std::chrono::system_clock::now().time_since_epoch();
            if (!result.scans.empty()) result.sinceLast_s = now.count() - *reader->received_s();
            result.others = reader->otherLabels();
            result.report = reader->live();
        } catch (const Error& e) {
            result.fault = e.what();
        }
        return result;
    });
    for (const std::uint16_t port : to) EXPECT_TRUE(test::waitForListener(port));
    const test::UdpEnd sensor;
    for (const auto& [port, payload] : packets) {
        sensor.send(payload, to[port]);
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    return drive.get();
}

void expectRecorded(const Drive& drive, const std::string& pcap, std::size_t fewest,
                    const std::string& sensorFile = "") {
    EXPECT_EQ(drive.fault, "");
    io::ScanSource source;
    source.path = pcap;
    source.sensorFile = sensorFile;
    const auto reader = io::openScans(source);
    std::vector<Scan> scans;
    while (auto scan = reader->next()) scans.push_back(*scan);
    EXPECT_GE(scans.size(), fewest);
    ASSERT_EQ(drive.scans.size(), scans.size());
    for (std::size_t i = 0; i < scans.size(); ++i) test::expectSameScan(drive.scans[i], scans[i]);
    EXPECT_EQ(drive.report->droppedScans, 0U);
    EXPECT_EQ(drive.report->notRecorded, 0U);
}

TEST(LiveReader, Velodyne) {
    const test::TemporaryFolder folder;
    const auto scan = spinner_test::vlp16().scan();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(scan.scan_packets.data());
    Packets packets;
    for (int turn = 0; turn < 6; ++turn)
        for (std::size_t i = 0; i < scan.scan_packets.size(); ++i)
            packets.emplace_back(0, Bytes(bytes + 1206 * i, bytes + 1206 * (i + 1)));
    const std::string pcap = folder / "v.pcap";
    const auto drive = sent(packets, pcap);
    expectRecorded(drive, pcap, 3);
    EXPECT_LE(drive.report->packets + drive.report->lostPackets, packets.size());
    EXPECT_LT(drive.sinceLast_s, 2);  // `idle_s` is 3
}

TEST(LiveReader, OusterWithItsJsonBesideTheRecording) {
    const test::TemporaryFolder folder;
    const test::OusterToy toy;
    test::writeText(folder / "sensor.json", toy.json().dump());
    Packets packets;
    for (std::size_t i = 0; i < 6 * 32; ++i)
        packets.emplace_back(0, toy.packet(static_cast<std::uint16_t>(i / 32), i % 32));
    const std::string pcap = folder / "o.pcap";
    const auto drive = sent(packets, pcap, folder / "sensor.json");
    expectRecorded(drive, pcap, 3);
    EXPECT_EQ(test::readText(folder / "o.json"), toy.json().dump());
}

TEST(LiveReader, OusterWithoutJsonSaysSo) {
    const test::TemporaryFolder folder;
    const test::OusterToy toy;
    Packets packets;
    for (std::size_t i = 0; i < 64; ++i)
        packets.emplace_back(0, toy.packet(static_cast<std::uint16_t>(i / 32), i % 32));
    const auto drive = sent(packets, "");
    EXPECT_NE(drive.fault.find("--sensor-info"), std::string::npos) << drive.fault;
}

TEST(LiveReader, OusterGivesItsJsonAway) {
    const test::TemporaryFolder folder;
    const test::OusterToy toy;
    const test::HttpEnd sensor(toy.json().dump());
    Packets packets;
    for (std::size_t i = 0; i < 6 * 32; ++i)
        packets.emplace_back(0, toy.packet(static_cast<std::uint16_t>(i / 32), i % 32));
    const std::string pcap = folder / "o.pcap";
    const auto drive = sent(packets, pcap, "", 1, sensor.port());
    expectRecorded(drive, pcap, 3);
    EXPECT_EQ(test::readText(folder / "o.json"), toy.json().dump());
    const auto requests = sensor.requests();
    ASSERT_EQ(requests.size(), 1U);
    EXPECT_EQ(requests[0].rfind("GET /api/v1/sensor/metadata HTTP/1.0\r\n", 0), 0U) << requests[0];
}

TEST(LiveReader, AnswersOfAnOusterThatAreOfNoUse) {
    const test::OusterToy toy;
    Packets packets;
    for (std::size_t i = 0; i < 64; ++i)
        packets.emplace_back(0, toy.packet(static_cast<std::uint16_t>(i / 32), i % 32));
    const auto faultOf = [&](const test::HttpEnd& sensor) {
        const auto drive = sent(packets, "", "", 1, sensor.port());
        EXPECT_EQ(sensor.requests().size(), 1U) << "asked again";
        EXPECT_NE(drive.fault.find("--sensor-info"), std::string::npos) << drive.fault;
        return drive.fault;
    };
    const auto missing = faultOf(test::HttpEnd("nothing", "404 Not Found"));
    EXPECT_NE(missing.find("404 Not Found"), std::string::npos) << missing;
    const auto other = faultOf(test::HttpEnd("{\"a\": 1}"));
    EXPECT_NE(other.find("not an Ouster metadata json"), std::string::npos) << other;
    const auto silent = faultOf(test::HttpEnd(""));
    EXPECT_NE(silent.find("no answer within 3 s"), std::string::npos) << silent;
}

TEST(LiveReader, Hesai) {
    const test::TemporaryFolder folder;
    const std::string pcap = folder / "h.pcap";
    const auto drive = sent(toOnePort(test::hesaiDrive(test::hesaiToys()[3], 6)), pcap);
    expectRecorded(drive, pcap, 3);
}

TEST(LiveReader, RobosenseWithItsDescriptionAtAnotherPort) {
    const test::TemporaryFolder folder;
    const auto toy = test::robosenseToys()[0];
    Packets packets = toOnePort(test::robosenseDrive(toy, 6));
    packets.insert(packets.begin() + 20, {1, test::robosenseDescription(toy)});
    const std::string pcap = folder / "r.pcap";
    const auto drive = sent(packets, pcap, "", 2);
    expectRecorded(drive, pcap, 3);
}

TEST(LiveReader, NoPacketOfALidar) {
    const auto drive = sent({{0, Bytes(100)}, {0, {}}, {0, Bytes(60000)}}, "");
    EXPECT_NE(drive.fault.find("no packets came to 'udp://127.0.0.1:"), std::string::npos)
        << drive.fault;
}

TEST(LiveReader, APortInUse) {
    const test::UdpEnd taken;
    io::ScanSource source;
    source.path = "udp://127.0.0.1:" + std::to_string(taken.port());
    try {
        io::openScans(source);
        FAIL() << "opened";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find(std::to_string(taken.port())), std::string::npos);
    }
}
}  // namespace
