#include <gtest/gtest.h>

#include <cmath>

#include "memory_limit.h"
#include "pcap_writer.h"
#include "recordings/packet_decoder.h"
#include "recordings/velodyne.h"
#include "spinner.h"
#include "test_data.h"

namespace {
using namespace delio;
using namespace delio::spinner_test;
using delio::test::Bytes;
using delio::test::putAt;
constexpr double kNow_s = 1600000000;  // 1600 s after a full hour

/** A turn's packets, a millisecond each, that go round `turns` times. */
std::vector<Bytes> packetsOf(const Spinner& spinner, int turns) {
    const auto scan = spinner.scan();
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(scan.scan_packets.data());
    std::vector<Bytes> packets;
    for (int turn = 0; turn < turns; ++turn)
        for (std::size_t i = 0; i < scan.scan_packets.size(); ++i) {
            packets.emplace_back(bytes + 1206 * i, bytes + 1206 * (i + 1));
            putAt(packets.back(), 1200,
                  static_cast<std::uint32_t>(1600000000 + 1000 * packets.size()));
        }
    return packets;
}

std::vector<Scan> scansOf(io::PacketDecoder& decoder, const std::vector<Bytes>& packets) {
    std::vector<Scan> scans;
    const auto takeAll = [&] {
        while (auto scan = decoder.take()) scans.push_back(*scan);
    };
    double time_s = kNow_s;
    for (const Bytes& packet : packets) {
        decoder.add(packet.data(), packet.size(), time_s += 1e-3);
        takeAll();
    }
    decoder.finish();
    takeAll();
    return scans;
}

std::vector<Scan> scansOf(const std::vector<Bytes>& packets) {
    return scansOf(*io::velodyneDecoder(""), packets);
}

TEST(PacketsVelodyne, TurnsOfKnownWalls) {
    for (const Spinner& spinner : {vlp16(), hdl32()}) {
        const auto scans = scansOf(packetsOf(spinner, 3));
        ASSERT_EQ(scans.size(), 3U);
        for (const Scan& scan : scans) {
            EXPECT_EQ(scan.points->size(), 32U * static_cast<std::size_t>(spinner.shots()));
            EXPECT_EQ(offTheWalls(scan), 0U);
            EXPECT_EQ(scan.rings.size(), scan.points->size());
        }
    }
}

TEST(PacketsVelodyne, ATurnEndsWithinAPacket) {
    auto packets = packetsOf(vlp16(), 2);
    for (Bytes& packet : packets)  // 2 deg on: azimuth 0 is met before the end of a packet
        for (std::size_t b = 0; b < 12; ++b) {
            std::uint16_t azimuth = 0;
            std::memcpy(&azimuth, &packet[100 * b + 2], 2);
            putAt(packet, 100 * b + 2, static_cast<std::uint16_t>((azimuth + 200) % 36000));
        }
    const auto scans = scansOf(packets);
    ASSERT_EQ(scans.size(), 2U);  // what is left after the second turn is less than half of one
    EXPECT_EQ(scans[0].points->size(), 32U * 895);
    EXPECT_EQ(scans[1].points->size(), 32U * 900);
    EXPECT_EQ(scans[1].times_s.front(), 0);
    EXPECT_NEAR(scans[1].stamp_s - scans[0].stamp_s, 895.0 / 12 * 1e-3, 1e-6);
}

TEST(PacketsVelodyne, TimesAreThoseOfTheFirings) {
    const auto scans = scansOf(packetsOf(vlp16(), 2));
    ASSERT_EQ(scans.size(), 2U);
    EXPECT_NEAR(scans[0].stamp_s, kNow_s + 1e-3, 1e-6);
    EXPECT_NEAR(scans[1].stamp_s, kNow_s + 76e-3, 1e-6);
    const auto& times_s = scans[1].times_s;
    ASSERT_EQ(times_s.size(), scans[1].points->size());
    for (std::size_t i = 0; i < times_s.size(); ++i) {
        const auto k = static_cast<int>(i % 32);
        const double block = static_cast<double>(i / 32) + vlp16().share(k);
        ASSERT_NEAR(times_s[i], block * 1e-3 / 12, 1e-6) << i;
    }
}

TEST(PacketsVelodyne, DualReturnsAreMeasuredAtOnce) {
    Spinner spinner = vlp16();
    spinner.dual = true;
    const auto scans = scansOf(packetsOf(spinner, 2));
    ASSERT_EQ(scans.size(), 2U);
    const auto shots = static_cast<std::size_t>(spinner.shots());
    for (const Scan& scan : scans) {
        EXPECT_EQ(scan.points->size(), 34 * shots);
        EXPECT_EQ(offTheWalls(scan), 2 * shots);
        // 32 first returns, then the two second ones of laser 3.
        EXPECT_NEAR(scan.times_s[32], scan.times_s[3], 1e-7);
        EXPECT_NEAR(scan.times_s[34] - scan.times_s[0], 1e-3 / 6, 1e-7);
    }
}

Bytes packet32C(int turn, std::uint16_t units) {
    Bytes packet(1206);
    for (std::size_t b = 0; b < 12; ++b) {
        packet[100 * b] = 0xFF;
        packet[100 * b + 1] = 0xEE;
        putAt(packet, 100 * b + 2,
              static_cast<std::uint16_t>((turn * 12 + static_cast<int>(b)) * 20 % 36000));
        for (std::size_t k = 0; k < 32; ++k) putAt(packet, 100 * b + 4 + 3 * k, units);
    }
    putAt(packet, 1200, static_cast<std::uint32_t>(1600000000 + 663 * turn));
    packet[1204] = 0x37;
    packet[1205] = 0x28;
    return packet;
}

TEST(PacketsVelodyne, AnglesOfTheVlp32C) {
    std::vector<Bytes> packets;
    for (int i = 0; i < 151; ++i) packets.push_back(packet32C(i, 2500));
    const auto scans = scansOf(packets);
    ASSERT_EQ(scans.size(), 1U);
    ASSERT_EQ(scans[0].points->size(), 32U * 1800);
    float x = 0, y = 0, z = 0;
    // Lasers 0 and 1 fire first and at once, at azimuth 0; clockwise is to the right.
    scans[0].points->getPoint(0, x, y, z);
    EXPECT_NEAR(std::hypot(x, y, z), 10, 1e-5);
    EXPECT_NEAR(z, -10 * std::sin(25 * M_PI / 180), 1e-5);
    EXPECT_NEAR(std::atan2(-y, x) * 180 / M_PI, 1.4, 1e-5);
    scans[0].points->getPoint(1, x, y, z);
    EXPECT_NEAR(std::atan2(-y, x) * 180 / M_PI, -4.2, 1e-5);
    // Laser 29 is of the 15th pair.
    scans[0].points->getPoint(29, x, y, z);
    EXPECT_NEAR(z, 10 * std::sin(15 * M_PI / 180), 1e-5);
    EXPECT_NEAR(std::atan2(-y, x) * 180 / M_PI, -1.4 + 0.2 * 14 * 2.304 / 55.296, 1e-4);
}

TEST(PacketsVelodyne, APuckHiResLooksFromMinus10To10) {
    const auto& lasers = io::velodyneModel("Puck Hi-Res", "").calibration.laser_corrections;
    ASSERT_EQ(lasers.size(), 16U);
    EXPECT_NEAR(lasers[0].verticalCorrection, -10, 1e-9);
    EXPECT_NEAR(lasers[1].verticalCorrection, 2.0 / 3, 1e-9);
    EXPECT_NEAR(lasers[15].verticalCorrection, 10, 1e-9);
}

std::string faultOf(const std::vector<Bytes>& packets, const std::string& calibration = "") {
    try {
        scansOf(*io::velodyneDecoder(calibration), packets);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(PacketsVelodyne, OtherSensorsAreErrors) {
    auto packets = packetsOf(vlp16(), 1);
    EXPECT_EQ(faultOf(packets), "");
    packets[5][1205] = 0x21;
    EXPECT_NE(faultOf(packets).find("HDL-32E is among packets of a VLP-16"), std::string::npos);
    packets[5][1205] = 0x77;
    EXPECT_NE(faultOf(packets).find("0x77"), std::string::npos);
    EXPECT_NE(faultOf(packets, "/none.xml").find("/none.xml"), std::string::npos);
    // Every HDL-64E has a calibration of its own.
    EXPECT_NE(faultOf(packetsOf(hdl64(1), 1)).find("calibration of the Velodyne HDL-64E"),
              std::string::npos);
}

TEST(PacketsVelodyne, ModelsThatAreNotDecodedAreNamed) {
    Bytes packet = packet32C(0, 2500);
    const auto faultWith = [&](std::uint8_t factoryByte) {
        packet[1205] = factoryByte;
        return faultOf({packet});
    };
    EXPECT_NE(faultWith(0x23).find("Velodyne VLP-32A or VLP-32B are not supported"),
              std::string::npos);
    EXPECT_NE(faultWith(0x31).find("Velodyne Velarray are not supported"), std::string::npos);
}

TEST(PacketsVelodyne, LessThanHalfATurnSaysSo) {
    auto packets = packetsOf(vlp16(), 1);
    packets.resize(30);
    EXPECT_NE(faultOf(packets).find("only 143 of 360 degrees in 30 packets"), std::string::npos)
        << faultOf(packets);
    EXPECT_EQ(faultOf({}), "");
}

TEST(PacketsVelodyne, WrongClocksOfPacketsAreInterpolated) {
    const auto right = scansOf(packetsOf(vlp16(), 3));
    auto packets = packetsOf(vlp16(), 3);
    for (const std::size_t i : {10U, 80U, 81U, 100U})  // within what a recorder may be late
        putAt(packets[i], 1200, static_cast<std::uint32_t>(1600000000 + 1000 * i + 330000));
    putAt(packets[120], 1200, 0U);
    const auto decoder = io::velodyneDecoder("");
    const auto scans = scansOf(*decoder, packets);
    ASSERT_EQ(scans.size(), 3U);
    for (std::size_t s = 0; s < scans.size(); ++s) {
        EXPECT_NEAR(scans[s].stamp_s, right[s].stamp_s, 1e-3);
        ASSERT_EQ(scans[s].times_s.size(), right[s].times_s.size());
        for (std::size_t i = 0; i < scans[s].times_s.size(); ++i)
            ASSERT_NEAR(scans[s].times_s[i], right[s].times_s[i], 1.5e-3) << s << " " << i;
    }
    ASSERT_EQ(decoder->findings().size(), 1U);
    EXPECT_NE(decoder->findings()[0].find("4 packets (first in scan 0)"), std::string::npos)
        << decoder->findings()[0];
}

TEST(PacketsVelodyne, CalibrationsThatClaimTooMuchAreRefused) {
    const test::TemporaryFolder folder;
    const std::string file = (folder / "sensor.yaml").string();
    std::string nested;
    for (int i = 0; i < 200000; ++i) nested += "- ";
    for (const std::string& text :
         {nested, std::string(200000, '['), std::string("num_lasers: 400000000\nlasers: []\n"),
          std::string("num_lasers: -1\n"), std::string("lasers\n")}) {
        test::writeText(file, text);
        const test::MemoryLimit limit(500);
        EXPECT_NE(faultOf(packetsOf(vlp16(), 1), file).find("is not a Velodyne calibration"),
                  std::string::npos)
            << text.substr(0, 40);
    }
}

TEST(PacketsVelodyne, ClocksThatAreNotSetOrStand) {
    io::VelodyneClock set, unset, stands;
    EXPECT_NEAR(set.timeOf(1600000500, kNow_s), kNow_s + 0.0005, 1e-6);
    EXPECT_NEAR(set.timeOf(1600010500, kNow_s + 0.02), kNow_s + 0.0105, 1e-6);
    EXPECT_NEAR(unset.timeOf(3599999000, kNow_s), kNow_s, 1e-6);
    EXPECT_NEAR(unset.timeOf(1000, kNow_s + 0.1), kNow_s + 0.002, 1e-6);
    EXPECT_NEAR(unset.timeOf(900001000, kNow_s + 0.2), kNow_s + 0.102, 1e-6);
    EXPECT_NEAR(stands.timeOf(0, kNow_s), kNow_s, 1e-6);
    EXPECT_NEAR(stands.timeOf(0, kNow_s + 0.5), kNow_s + 0.5, 1e-6);
}

TEST(PacketsVelodyne, ARecordersClockMayLeap) {
    io::VelodyneClock clock;
    EXPECT_NEAR(clock.timeOf(1600000500, kNow_s), kNow_s + 0.0005, 1e-6);
    EXPECT_NEAR(clock.timeOf(1600001500, kNow_s + 1e6), kNow_s + 0.0015, 1e-6);
    EXPECT_NEAR(clock.timeOf(1600002500, kNow_s + 0.002), kNow_s + 0.0025, 1e-6);
}
}  // namespace
