#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cmath>

#include "delio/core/error.h"
#include "recordings/packet_decoder.h"
#include "recordings/sources.h"
#include "spinning_packets.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
using test::HesaiToy;
using test::TemporaryFolder;
using test::TimedPacket;
constexpr double kBegin_s = 1700000000;

std::vector<Scan> scansOf(io::PacketDecoder& decoder, const std::vector<TimedPacket>& packets,
                          double recordedLater_s = 0.001) {
    std::vector<Scan> scans;
    for (const TimedPacket& packet : packets) {
        EXPECT_TRUE(decoder.takes(packet.bytes.size()));
        decoder.add(packet.bytes.data(), packet.bytes.size(), packet.time_s + recordedLater_s);
        while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
    }
    decoder.finish();
    while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
    return scans;
}

std::string faultOf(const std::vector<TimedPacket>& packets, const std::string& angles = "") {
    try {
        const auto decoder = io::hesaiDecoder(angles);
        scansOf(*decoder, packets);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

/** Nanoseconds from a block to a laser. */
double firing_us(const HesaiToy& toy, std::size_t laser) {
    if (toy.name == "PandarXT-16") return 0.368 + 3.024 * static_cast<double>(laser);
    if (toy.name == "PandarXT-32") return 0.368 + 1.512 * static_cast<double>(laser);
    if (toy.name == "XT32M2X") return 0.368 + 2.888 * static_cast<double>(laser % 16);
    return std::nan("");  // irregular
}

/** Every point lies where its laser points to at its azimuth, at its time. */
void expectPoints(const Scan& scan, const HesaiToy& toy, std::size_t firstShot,
                  std::size_t turnsBefore) {
    ASSERT_EQ(scan.rings.size(), scan.points->size());
    ASSERT_EQ(scan.times_s.size(), scan.points->size());
    const auto* cloud = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scan.points.get());
    ASSERT_TRUE(cloud);
    const std::size_t perShot = toy.lasers * toy.returns();
    for (std::size_t i = 0; i < cloud->size(); ++i) {
        const std::size_t shot = firstShot + i / perShot, laser = i % perShot / toy.returns();
        const int azimuth = toy.step * static_cast<int>(shot);
        const std::size_t which = i % toy.returns();
        float x = 0, y = 0, z = 0;
        cloud->getPoint(i, x, y, z);
        const double range = 0.004 * test::usualDistance(laser, azimuth, which);
        const double up = test::toyElevation(laser) * M_PI / 180,
                     turned = (0.01 * azimuth + test::toyAzimuth(laser)) * M_PI / 180;
        ASSERT_EQ(scan.rings[i], laser);
        ASSERT_NEAR(x, range * std::cos(up) * std::sin(turned), 1e-4) << i;
        ASSERT_NEAR(y, range * std::cos(up) * std::cos(turned), 1e-4) << i;
        ASSERT_NEAR(z, range * std::sin(up), 1e-4) << i;
        ASSERT_FLOAT_EQ(cloud->getPointIntensity(i), static_cast<float>(laser) / 255);
        if (std::isnan(firing_us(toy, laser))) continue;
        const std::size_t shots = 36000 / static_cast<std::size_t>(toy.step);
        const std::size_t all = turnsBefore * shots + shot, inPacket = all % toy.shots();
        const double after_us = toy.first_us + firing_us(toy, laser) -
                                toy.next_us * static_cast<double>(toy.shots() - 1 - inPacket);
        const double time_s =
            kBegin_s + 1e-6 * (toy.next_us * static_cast<double>(all - inPacket) + after_us);
        ASSERT_NEAR(scan.stamp_s + static_cast<double>(scan.times_s[i]), time_s, 2e-6) << i;
    }
}

TEST(PacketsHesai, EveryModelAndReturnMode) {
    const TemporaryFolder folder;
    auto toys = test::hesaiToys();
    toys.push_back(test::hesai128Toy(false));
    toys.push_back(test::hesai128Toy(true));
    for (HesaiToy toy : toys)
        for (const int mode : {0x37, 0x39}) {
            SCOPED_TRACE(toy.name + " " + std::to_string(mode));
            toy.mode = static_cast<std::uint8_t>(mode);
            test::writeText(folder / "angles.csv", test::toyAngles(toy.lasers));
            const auto decoder = io::hesaiDecoder((folder / "angles.csv").string());
            const auto scans = scansOf(*decoder, test::hesaiDrive(toy, 2.7));
            EXPECT_EQ(decoder->sensor(), "Hesai " + toy.name);
            ASSERT_EQ(scans.size(), 3U);
            const std::size_t perTurn = 1800 * toy.lasers * toy.returns();
            EXPECT_EQ(scans[0].points->size(), perTurn);
            EXPECT_EQ(scans[1].points->size(), perTurn);
            for (std::size_t i = 0; i < scans.size(); ++i) expectPoints(scans[i], toy, 0, i);
            EXPECT_TRUE(decoder->findings().empty());
        }
}

TEST(PacketsHesai, LasersOfAQt128TakeTurns) {
    const HesaiToy toy = test::hesaiToys().back();
    const auto decoder = io::hesaiDecoder("");
    const auto silent = [](std::size_t laser, int azimuth, std::size_t which) {
        // Of the lower ones a quarter fires at each azimuth.
        const bool isFirst = azimuth / 20 % 2 == 0;
        const bool isSilent = isFirst ? laser < 32 : laser >= 32 && laser < 64;
        return isSilent ? 0 : test::usualDistance(laser, azimuth, which);
    };
    const auto scans = scansOf(*decoder, test::hesaiDrive(toy, 1.6, kBegin_s, silent));
    ASSERT_EQ(scans.size(), 2U);
    const Scan& scan = scans[0];
    EXPECT_EQ(scan.points->size(), 1800U * 96);
    const auto timeOf = [&](std::uint16_t ring) {
        const auto at = std::find(scan.rings.begin(), scan.rings.end(), ring) - scan.rings.begin();
        return static_cast<double>(scan.times_s[static_cast<std::size_t>(at)]);
    };
    // Laser 40 fires 33.992 us after a block of the first kind, laser 8 8.648 us after the next
    // one.
    EXPECT_NEAR(timeOf(8) - timeOf(40), 1e-6 * (111.11 + 8.648 - 33.992), 1e-7);
}

/** The first turn of a drive, by the model's default angles. */
Scan firstScanOf(const HesaiToy& toy) {
    const auto decoder = io::hesaiDecoder("");
    auto scans = scansOf(*decoder, test::hesaiDrive(toy, 1.6));
    EXPECT_EQ(decoder->sensor(), "Hesai " + toy.name);
    return scans.at(0);
}

double elevationOf(const Scan& scan, std::size_t i) {
    float x = 0, y = 0, z = 0;
    scan.points->getPoint(i, x, y, z);
    return std::atan2(double{z}, std::hypot(double{x}, double{y})) * 180 / M_PI;
}

TEST(PacketsHesai, StatusTellsAPandar128FromAnOt128) {
    for (const bool isOt128 : {false, true}) {
        const Scan scan = firstScanOf(test::hesai128Toy(isOt128));
        EXPECT_NEAR(elevationOf(scan, 0), isOt128 ? 14.985 : 14.436, 1e-3);
        EXPECT_NEAR(elevationOf(scan, 127), isOt128 ? -24.765 : -25.016, 1e-3);
        // Lasers 1 and 4 of Hesai's files of firing times.
        EXPECT_NEAR(scan.times_s[0] - scan.times_s[3],
                    isOt128 ? 46.645e-6 - 6.289e-6 : 4.436e-6 - 2.431e-6, 1e-8);
        EXPECT_NEAR(scan.times_s[128] - scan.times_s[0], 55.556e-6, 3e-7);
    }
}

TEST(PacketsHesai, HighResolutionOfAnOt128) {
    HesaiToy toy = test::hesai128Toy(true);
    toy.state = 0;
    toy.step = 10;
    toy.next_us = 27.778;
    const Scan scan = firstScanOf(toy);
    EXPECT_EQ(scan.points->size(), 3600U * 128);
    EXPECT_NEAR(scan.times_s[0] - scan.times_s[3], 18.867e-6 - 6.289e-6, 1e-8);
    // A Unix time in a double is good to 0.24 us.
    EXPECT_NEAR(scan.times_s[128] - scan.times_s[0], 27.778e-6, 3e-7);
}

TEST(PacketsHesai, PartsOfAPacketOfAnOt128) {
    // Without functional safety, number and IMU: 17, 4 and 22 bytes less; with a signature.
    HesaiToy toy = test::hesai128Toy(true);
    toy.flags = 0;
    toy.bytes = 818;
    toy.stateAt -= 17;
    toy.modeAt -= 17;
    toy.dateAt -= 17;
    toy.clockAt -= 17;
    EXPECT_EQ(firstScanOf(toy).points->size(), 1800U * 128);
    toy.flags = 8;
    toy.bytes = 850;
    EXPECT_EQ(firstScanOf(toy).points->size(), 1800U * 128);
    // Confidences: a byte behind each return.
    toy = test::hesai128Toy(true);
    toy.flags |= 0x10;
    toy.returnBytes = 4;
    for (std::size_t* at : {&toy.bytes, &toy.stateAt, &toy.modeAt, &toy.dateAt, &toy.clockAt})
        *at += 256;
    EXPECT_EQ(firstScanOf(toy).points->size(), 1800U * 128);
    toy.flags = 7;
    const auto packets = test::hesaiDrive(toy, 0.1);
    EXPECT_NE(faultOf(packets).find("1117 bytes of an unknown Hesai"), std::string::npos);
}

TEST(PacketsHesai, ReturnsThatOnlyRepeatAreNone) {
    HesaiToy toy = test::hesaiToys()[3];
    toy.mode = 0x39;
    const auto decoder = io::hesaiDecoder("");
    const auto scans = scansOf(
        *decoder, test::hesaiDrive(toy, 1, kBegin_s, [](std::size_t laser, int, std::size_t which) {
            if (laser == 5) return 0;
            return laser == 3 && which == 1 ? 3000 : 2000;
        }));
    ASSERT_EQ(scans.size(), 1U);
    EXPECT_EQ(scans[0].points->size(), 1800U * 32);  // one has two returns, one has none
}

TEST(PacketsHesai, ClockThatWasNeverSet) {
    const HesaiToy toy = test::hesaiToys()[2];
    const auto decoder = io::hesaiDecoder("");
    const auto scans = scansOf(*decoder, test::hesaiDrive(toy, 2), 86400);
    ASSERT_EQ(scans.size(), 2U);
    EXPECT_NEAR(scans[0].stamp_s, kBegin_s + 86400, 1e-3);
    EXPECT_NEAR(scans[1].stamp_s - scans[0].stamp_s, 1800 * 50e-6, 1e-6);
}

TEST(PacketsHesai, PacketsWithANumberOrASignature) {
    for (const std::size_t more : {4U, 32U}) {
        auto packets = test::hesaiDrive(test::hesaiToys()[1], 1);
        for (auto& packet : packets) packet.bytes.resize(packet.bytes.size() + more);
        const auto decoder = io::hesaiDecoder("");
        EXPECT_EQ(scansOf(*decoder, packets).size(), 1U);
    }
}

TEST(PacketsHesai, WhatCannotBeDecodedIsRefused) {
    const auto toys = test::hesaiToys();
    auto packets = test::hesaiDrive(toys[3], 1);
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    auto changed = packets;
    changed[9].bytes[toys[3].modeAt] = 0x77;
    has(faultOf(changed), "unknown return mode 0x77");
    changed = packets;
    changed[9].bytes[9] = 0;
    has(faultOf(changed), "has no unit");
    changed = packets;
    changed[9] = test::hesaiDrive(toys[2], 1)[0];
    has(faultOf(changed), "Hesai PandarXT-16 is among packets of a PandarXT-32");
    changed = packets;
    changed[0].bytes[6] = 31;
    has(faultOf(changed), "1080 bytes of an unknown Hesai");
    packets.resize(80);
    has(faultOf(packets), "of 360 degrees in 640 blocks of a Hesai PandarXT-32");
    auto toy128 = test::hesai128Toy(true);
    toy128.status = 137;
    has(faultOf(test::hesaiDrive(toy128, 0.1)), "Hesai JT128 are not supported");
    toy128.status = 128;
    toy128.lasers = 90;
    has(faultOf(test::hesaiDrive(toy128, 0.1)), "861 bytes of an unknown Hesai");
    EXPECT_FALSE(io::hesaiDecoder("")->takes(1079));
    EXPECT_FALSE(io::hesaiDecoder("")->takes(0));
}

TEST(PacketsHesai, TablesOfAnglesAreChecked) {
    const TemporaryFolder folder;
    const auto packets = test::hesaiDrive(test::hesaiToys()[3], 1);
    const auto fault = [&](const std::string& text) {
        test::writeText(folder / "a.csv", text);
        return faultOf(packets, (folder / "a.csv").string());
    };
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    EXPECT_EQ(fault(test::toyAngles(32)), "");
    EXPECT_EQ(fault(test::toyAngles(32, 2)), "");
    has(fault(test::toyAngles(31)), "has 31 channels and the sensor has 32");
    has(fault(test::toyAngles(33)), "more than 32 channels");
    has(fault("a\n1,2,3\n1,2,3\n"), "line 3 is not of channel 2");
    has(fault("1,2,3\n2,x,3\n"), "line 2 has 1 numbers");
    has(fault("1,91,0\n"), "line 1 has no angles");
    has(faultOf(packets, (folder / "none.csv").string()), "no such file of beam angles");
}

TEST(PacketsHesai, OfAPcap) {
    const TemporaryFolder folder;
    test::PcapWriter writer;
    for (const auto& packet : test::hesaiDrive(test::hesaiToys()[3], 2.2))
        writer.add(packet.bytes, packet.time_s + 0.001);
    writer.write((folder / "d.pcap").string());
    const auto reader = io::openScans((folder / "d.pcap").string());
    EXPECT_EQ(
        io::describe(reader->recording()),
        "Hesai PandarXT-32, 11.1 Hz, points with times, not de-skewed by the recorder (pcap)");
    EXPECT_EQ(reader->label(), "hesai");
    std::size_t scans = 0;
    while (reader->next()) ++scans;
    EXPECT_EQ(scans, 2U);
}
}  // namespace
