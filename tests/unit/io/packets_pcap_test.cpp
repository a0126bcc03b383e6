#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "io/packets/pcap_reader.h"
#include "ouster_packets.h"
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
