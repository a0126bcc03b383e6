#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "ouster_packets.h"
#include "recordings/sources.h"
#include "spinner.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
using test::OusterToy;
using test::PcapWriter;
using test::TemporaryFolder;
constexpr double kNow_s = 1600000000;

void addVelodyne(PcapWriter& writer, int turns, double start_s = kNow_s) {
    const auto scan = spinner_test::vlp16().scan();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(scan.scan_packets.data());
    for (int turn = 0; turn < turns; ++turn)
        for (std::size_t i = 0; i < scan.scan_packets.size(); ++i)
            writer.add(Bytes(bytes + 1206 * i, bytes + 1206 * (i + 1)), start_s += 1e-3);
}

struct Outcome {
    std::vector<Scan> scans;
    std::string fault, label, sensor;
    std::set<std::string> others;
};

Outcome readAll(const io::ScanSource& source) {
    Outcome outcome;
    try {
        const auto reader = io::openPcap(source);
        outcome.label = reader->label();
        outcome.sensor = reader->recording().sensor;
        try {
            while (auto scan = reader->next()) outcome.scans.push_back(*scan);
        } catch (const Error& e) {
            outcome.fault = e.what();
            EXPECT_FALSE(reader->next());
        }
        outcome.others = reader->otherLabels();
    } catch (const Error& e) {
        outcome.fault = e.what();
    }
    return outcome;
}

Outcome readAll(const std::filesystem::path& path) {
    io::ScanSource source;
    source.path = path.string();
    return readAll(source);
}

TEST(PacketsPcap, EveryLinkLayer) {
    const TemporaryFolder folder;
    const auto file = folder / "drive.pcap";
    Bytes vlan(12), cooked(14), cooked2{0x08, 0x00}, null{2, 0, 0, 0};
    test::appendBig(vlan, 0x81000005, 4);
    test::appendBig(vlan, 0x0800, 2);
    test::appendBig(cooked, 0x0800, 2);
    cooked2.resize(20);
    const std::vector<std::pair<std::uint32_t, Bytes>> links{{1, PcapWriter::ethernet()},
                                                             {1, vlan},
                                                             {113, cooked},
                                                             {276, cooked2},
                                                             {0, null},
                                                             {101, {}}};
    for (const auto& [type, link] : links) {
        PcapWriter writer;
        writer.linkType = type;
        writer.link = link;
        addVelodyne(writer, 2);
        writer.write(file.string());
        const auto outcome = readAll(file);
        EXPECT_EQ(outcome.fault, "") << type;
        ASSERT_EQ(outcome.scans.size(), 2U) << type;
        EXPECT_EQ(outcome.scans[1].index, 1U);
        EXPECT_EQ(spinner_test::offTheWalls(outcome.scans[1]), 0U);
        EXPECT_EQ(outcome.label, "velodyne");
        EXPECT_EQ(outcome.sensor, "Velodyne VLP-16");
    }
    PcapWriter wifi;
    wifi.linkType = 105;
    wifi.write(file.string());
    EXPECT_NE(readAll(file).fault.find("link type"), std::string::npos);
}

TEST(PacketsPcap, FragmentsInAnyOrder) {
    const TemporaryFolder folder;
    const OusterToy toy;
    test::writeText(folder / "drive.json", toy.json().dump());
    for (const bool backwards : {false, true}) {
        PcapWriter writer;
        writer.port = 7502;
        writer.backwards = backwards;
        for (std::size_t i = 0; i < 64; ++i)
            writer.add(toy.packet(static_cast<std::uint16_t>(i / 32), i % 32), kNow_s);
        writer.write((folder / "drive.pcap").string());
        const auto outcome = readAll(folder / "drive.pcap");
        EXPECT_EQ(outcome.fault, "");
        ASSERT_EQ(outcome.scans.size(), 2U);
        EXPECT_EQ(outcome.scans[0].points->size(), 16U * 512);
    }
}

TEST(PacketsPcap, CutOffAnywhere) {
    const TemporaryFolder folder;
    const auto file = folder / "cut.pcap";
    PcapWriter writer;
    addVelodyne(writer, 3);
    constexpr std::size_t kPacket = 16 + 14 + 28 + 1206, kTurn = 75 * kPacket;
    const std::vector<std::pair<std::size_t, std::size_t>> cuts{{0, 0},
                                                                {10, 0},
                                                                {24 + 100, 0},
                                                                {24 + kTurn + 100, 1},
                                                                {24 + 2 * kTurn + 5, 2},
                                                                {24 + 3 * kTurn - 1, 3}};
    for (const auto& [bytes, scans] : cuts) {
        writer.write(file.string(), bytes);
        const auto outcome = readAll(file);
        EXPECT_EQ(outcome.scans.size(), scans) << bytes;
        EXPECT_NE(outcome.fault.find("cut.pcap"), std::string::npos) << bytes << outcome.fault;
        EXPECT_EQ(outcome.fault.find('\n'), std::string::npos);
    }
}

TEST(PacketsPcap, NothingToRead) {
    const TemporaryFolder folder;
    EXPECT_NE(readAll(folder / "none.pcap").fault.find("none.pcap"), std::string::npos);
    test::writeText(folder / "text.pcap", "this is not a pcap, but a text of some length");
    EXPECT_NE(readAll(folder / "text.pcap").fault.find("text.pcap"), std::string::npos);
    PcapWriter writer;
    writer.write((folder / "empty.pcap").string());
    EXPECT_NE(readAll(folder / "empty.pcap").fault.find("no packets"), std::string::npos);
    writer.add(Bytes(512), kNow_s);
    writer.write((folder / "other.pcap").string());
    EXPECT_NE(readAll(folder / "other.pcap").fault.find("no packets"), std::string::npos);
    PcapWriter ouster;
    ouster.add(OusterToy().packet(0, 0), kNow_s);
    ouster.write((folder / "ouster.pcap").string());
    EXPECT_NE(readAll(folder / "ouster.pcap").fault.find("ouster.json"), std::string::npos);
    EXPECT_NE(readAll(folder / "ouster.pcap").fault.find("--sensor-info"), std::string::npos);
}

TEST(PacketsPcap, TheOnlyDescriptionInTheFolderIsTaken) {
    const TemporaryFolder folder;
    const OusterToy toy;
    PcapWriter writer;
    for (std::size_t i = 0; i < 32; ++i) writer.add(toy.packet(0, i), kNow_s);
    writer.write((folder / "drive.pcap").string());
    test::writeText(folder / "sensor.json", toy.json().dump());
    test::writeText(folder / "unrelated.json", "{}");
    EXPECT_EQ(readAll(folder / "drive.pcap").scans.size(), 1U);
    test::writeText(folder / "second.json", toy.json().dump());
    EXPECT_NE(readAll(folder / "drive.pcap").fault.find("drive.json"), std::string::npos);
    io::ScanSource source;
    source.path = (folder / "drive.pcap").string();
    source.sensorFile = (folder / "second.json").string();
    EXPECT_EQ(readAll(source).scans.size(), 1U);
}

void writeOuster(const std::filesystem::path& file, const OusterToy& toy,
                 std::size_t packets = 32) {
    PcapWriter writer;
    for (std::size_t i = 0; i < packets; ++i) writer.add(toy.packet(0, i), kNow_s);
    writer.write(file.string());
}

/** The json that an Ouster's recording was read with. */
std::string describedBy(const std::filesystem::path& pcap) {
    io::ScanSource source;
    source.path = pcap.string();
    return io::openPcap(source)->recording().kind;
}

TEST(PacketsPcap, OfSeveralDescriptionsTheMostAlikeIsTaken) {
    const TemporaryFolder folder;
    const OusterToy toy{"LEGACY"};
    for (const char* const name : {"window1", "window2", "OS-1_v2.3_lb_n3"})
        writeOuster(folder / (std::string(name) + ".pcap"), toy);
    for (const char* const name : {"window1_0", "window2_0", "OS-1_v2.3", "OS-0_v2.3", "other"})
        test::writeText(folder / (std::string(name) + ".json"), toy.json().dump());
    test::writeText(folder / "window1_digest.json", "{}");
    EXPECT_EQ(describedBy(folder / "window1.pcap"), "pcap, metadata 'window1_0.json'");
    EXPECT_EQ(describedBy(folder / "window2.pcap"), "pcap, metadata 'window2_0.json'");
    EXPECT_EQ(describedBy(folder / "OS-1_v2.3_lb_n3.pcap"), "pcap, metadata 'OS-1_v2.3.json'");
    test::writeText(folder / "window1_1.json", toy.json().dump());
    const std::string fault = readAll(folder / "window1.pcap").fault;
    for (const char* const name : {"window1.pcap", "window1_0.json", "window1_1.json"})
        EXPECT_NE(fault.find(name), std::string::npos) << fault;
    EXPECT_EQ(fault.find("other.json"), std::string::npos) << fault;
    test::writeText(folder / "window1.json", toy.json().dump());
    EXPECT_EQ(describedBy(folder / "window1.pcap"), "pcap");
}

TEST(PacketsPcap, ADescriptionThatDoesNotFitIsNotTaken) {
    const TemporaryFolder folder;
    OusterToy toy, other;
    const OusterToy longer{"RNG19_RFL8_SIG16_NIR16_DUAL"};
    toy.serial = 5;
    other.serial = 6;
    writeOuster(folder / "drive.pcap", toy);
    test::writeText(folder / "drive_a.json", other.json().dump());
    // The only one says in what it does not fit.
    std::string fault = readAll(folder / "drive.pcap").fault;
    for (const char* const part : {"drive.pcap", "drive_a.json", "number 5", "number 6"})
        EXPECT_NE(fault.find(part), std::string::npos) << fault;
    test::writeText(folder / "drive_b.json", longer.json().dump());
    test::writeText(folder / "sensor.json", toy.json().dump());
    EXPECT_EQ(describedBy(folder / "drive.pcap"), "pcap, metadata 'sensor.json'");
    io::ScanSource source;
    source.path = (folder / "drive.pcap").string();
    source.sensorFile = (folder / "drive_a.json").string();
    fault = readAll(source).fault;
    EXPECT_NE(fault.find("serial number 5"), std::string::npos) << fault;
    EXPECT_NE(fault.find("serial number 6"), std::string::npos) << fault;
}

TEST(PacketsPcap, TheDescriptionChoosesTheSensor) {
    const TemporaryFolder folder;
    OusterToy left, right;
    left.serial = 5;
    right.serial = 6;
    right.range_mm = 7000;
    PcapWriter writer;
    for (std::size_t i = 0; i < 32; ++i)
        for (const OusterToy* const toy : {&left, &right}) {
            writer.from = toy == &left ? 0xC0A801C9 : 0xC0A801CA;
            writer.add(toy->packet(0, i), kNow_s);
        }
    writer.write((folder / "two.pcap").string());
    test::writeText(folder / "right.json", right.json().dump());
    const auto outcome = readAll(folder / "two.pcap");
    EXPECT_EQ(outcome.fault, "");
    ASSERT_EQ(outcome.scans.size(), 1U);
    float x = 0, y = 0, z = 0;
    outcome.scans[0].points->getPoint(0, x, y, z);
    EXPECT_GT(std::hypot(x, y, z), 6);
    EXPECT_EQ(outcome.others, std::set<std::string>{"ouster:2368@192.168.1.201"});
}

TEST(PacketsPcap, LessThanHalfATurnSaysSo) {
    const TemporaryFolder folder;
    writeOuster(folder / "short.pcap", OusterToy(), 2);
    test::writeText(folder / "short.json", OusterToy().json().dump());
    auto outcome = readAll(folder / "short.pcap");
    EXPECT_TRUE(outcome.scans.empty());
    EXPECT_NE(outcome.fault.find("short.pcap': only 2 of the 32 packets of a revolution"),
              std::string::npos)
        << outcome.fault;
    PcapWriter writer;
    addVelodyne(writer, 1);
    constexpr std::size_t kPacket = 16 + 14 + 28 + 1206;
    writer.records.resize(20 * kPacket);
    writer.write((folder / "velodyne.pcap").string());
    outcome = readAll(folder / "velodyne.pcap");
    EXPECT_NE(outcome.fault.find("only 95 of 360 degrees in 20 packets of a Velodyne VLP-16"),
              std::string::npos)
        << outcome.fault;
}

TEST(PacketsPcap, OneOfTwoSensors) {
    const TemporaryFolder folder;
    PcapWriter writer;
    addVelodyne(writer, 1);
    writer.port = 2369;
    addVelodyne(writer, 2);
    io::ScanSource source;
    source.path = (folder / "two.pcap").string();
    writer.write(source.path);
    auto outcome = readAll(source);
    EXPECT_EQ(outcome.scans.size(), 1U);
    EXPECT_EQ(outcome.others, std::set<std::string>{"velodyne:2369"});
    source.label = "2369";
    outcome = readAll(source);
    EXPECT_EQ(outcome.scans.size(), 2U);
    EXPECT_EQ(outcome.label, "velodyne:2369");
    EXPECT_EQ(outcome.others, std::set<std::string>{"velodyne:2368"});
    source.label = "2370";
    EXPECT_NE(readAll(source).fault.find("2370"), std::string::npos);
}
}  // namespace
