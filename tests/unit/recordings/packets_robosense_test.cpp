#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>

#include "delio/core/error.h"
#include "recordings/packet_decoder.h"
#include "recordings/sources.h"
#include "spinning_packets.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
using test::RobosenseToy;
using test::TemporaryFolder;
using test::TimedPacket;
constexpr double kBegin_s = 1700000000;

std::vector<Scan> scansOf(io::PacketDecoder& decoder, const std::vector<TimedPacket>& packets) {
    std::vector<Scan> scans;
    for (const TimedPacket& packet : packets) {
        decoder.add(packet.bytes.data(), packet.bytes.size(), packet.time_s + 0.001);
        while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
    }
    decoder.finish();
    while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
    return scans;
}

std::vector<TimedPacket> described(const RobosenseToy& toy, double turns, std::size_t at = 0) {
    auto packets = test::robosenseDrive(toy, turns);
    const TimedPacket description{test::robosenseDescription(toy), packets[at].time_s};
    packets.insert(packets.begin() + static_cast<std::ptrdiff_t>(at), description);
    return packets;
}

std::string faultOf(const std::vector<TimedPacket>& packets, const std::string& angles = "") {
    try {
        const auto decoder = io::robosenseDecoder(angles);
        scansOf(*decoder, packets);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

/** Microseconds from a shot to a laser; NaN: irregular. */
double firing_us(const RobosenseToy& toy, std::size_t laser) {
    if (toy.name == "Bpearl 4.0") return 51.71 / 31 * static_cast<double>(laser);
    if (toy.name == "Bpearl")
        return 2.56 * static_cast<double>(laser % 8) + 25.68 * static_cast<double>(laser % 16 / 8) +
               1.28 * static_cast<double>(laser / 16);
    return std::nan("");
}

/** Every point lies on its laser's beam, which leaves the lens beside the axis; the sensor turns on
 *  until a laser fires. */
void expectPoints(const Scan& scan, const RobosenseToy& toy, double sense = 1) {
    const auto* cloud = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scan.points.get());
    ASSERT_TRUE(cloud);
    ASSERT_EQ(scan.rings.size(), cloud->size());
    ASSERT_EQ(scan.times_s.size(), cloud->size());
    const std::size_t perShot = toy.lasers * toy.returns;
    for (std::size_t i = 0; i < cloud->size(); ++i) {
        const std::size_t shot = i / perShot, laser = i % perShot / toy.returns;
        const double firing = firing_us(toy, laser);
        ASSERT_EQ(scan.rings[i], laser);  // the toy's lasers rise
        if (std::isnan(firing)) continue;
        const int azimuth = toy.step * static_cast<int>(shot);
        const double share = firing / toy.shot_us;
        const double shotAt = sense * (0.01 * (azimuth + toy.step * share)) * M_PI / 180;
        const double turned = shotAt + sense * test::toyAzimuth(laser) * M_PI / 180;
        const double up = test::toyElevation(laser) * M_PI / 180;
        const double range = toy.unit_m * test::usualDistance(laser, azimuth, i % toy.returns);
        float x = 0, y = 0, z = 0;
        cloud->getPoint(i, x, y, z);
        ASSERT_NEAR(x, range * std::cos(up) * std::cos(turned) + toy.lens_m * std::cos(shotAt),
                    1e-4);
        ASSERT_NEAR(y, -range * std::cos(up) * std::sin(turned) - toy.lens_m * std::sin(shotAt),
                    1e-4);
        ASSERT_NEAR(z, range * std::sin(up) + toy.height_m, 1e-4);
        ASSERT_NEAR(scan.times_s[i], 1e-6 * (toy.shot_us * static_cast<double>(shot) + firing),
                    2e-6);
    }
}

TEST(PacketsRobosense, EveryModel) {
    for (RobosenseToy toy : test::robosenseToys())
        for (const std::size_t returns : {1U, 2U}) {
            if (returns == 2 && toy.lasers == 128) continue;
            SCOPED_TRACE(toy.name);
            toy.returns = returns;
            const auto decoder = io::robosenseDecoder("");
            const auto scans = scansOf(*decoder, described(toy, 2.6));
            EXPECT_EQ(decoder->sensor(), "RoboSense " + toy.name);
            ASSERT_EQ(scans.size(), 3U);
            EXPECT_EQ(scans[0].points->size(), 1800 * toy.lasers * toy.returns);
            EXPECT_EQ(scans[1].points->size(), 1800 * toy.lasers * toy.returns);
            for (const Scan& scan : scans) expectPoints(scan, toy);
            EXPECT_NEAR(scans[0].stamp_s, kBegin_s, 1e-5);
            EXPECT_NEAR(scans[1].stamp_s - scans[0].stamp_s, 1800e-6 * toy.shot_us, 3e-6);
            EXPECT_TRUE(decoder->findings().empty());
        }
}

TEST(PacketsRobosense, AnglesMayComeLate) {
    const RobosenseToy toy = test::robosenseToys()[2];
    const auto decoder = io::robosenseDecoder("");
    const auto scans = scansOf(*decoder, described(toy, 2, 170));
    ASSERT_EQ(scans.size(), 2U);
    for (const Scan& scan : scans) expectPoints(scan, toy);
}

TEST(PacketsRobosense, AnglesOfATable) {
    const TemporaryFolder folder;
    const RobosenseToy toy = test::robosenseToys()[1];
    test::writeText(folder / "angle.csv", test::toyAngles(32, 2));
    const auto decoder = io::robosenseDecoder((folder / "angle.csv").string());
    const auto scans = scansOf(*decoder, test::robosenseDrive(toy, 1));
    ASSERT_EQ(scans.size(), 1U);
    expectPoints(scans[0], toy);
}

TEST(PacketsRobosense, BpearlThatTurnsTheOtherWay) {
    const RobosenseToy toy = test::robosenseToys()[1];
    auto packets = described(toy, 2);
    packets[0].bytes[337] = 1;
    const auto decoder = io::robosenseDecoder("");
    const auto scans = scansOf(*decoder, packets);
    ASSERT_GE(scans.size(), 2U);
    // The first turn ends where its begin is passed.
    EXPECT_GT(scans[0].points->size(), 1780U * 32);
    float x = 0, y = 0, z = 0;
    scans[0].points->getPoint(32U * 450, x, y, z);  // a quarter of a turn on
    EXPECT_GT(y, 5);
}

TEST(PacketsRobosense, BlindSectorsTakeTheirTime) {
    const RobosenseToy toy = test::robosenseToys()[2];
    auto packets = described(toy, 2);
    // Blocks 6 to 11 of a packet are 60 deg farther on.
    for (std::size_t b = 6; b < 12; ++b)
        test::putBig(packets[40].bytes, 42 + 100 * b + 2, 20U * (39U * 12 + b) + 6000, 2);
    const auto decoder = io::robosenseDecoder("");
    const auto scans = scansOf(*decoder, packets);
    const std::size_t at = (39 * 12 + 6) * 32;
    EXPECT_NEAR(scans.at(0).times_s[at] - scans[0].times_s[at - 32], 301 * 55.56e-6, 1e-5);
}

TEST(PacketsRobosense, WhatCannotBeDecodedIsRefused) {
    const RobosenseToy toy = test::robosenseToys()[0];
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    has(faultOf(test::robosenseDrive(toy, 1)),
        "angles of the beams of the RoboSense Helios are not known");
    auto packets = described(toy, 1);
    packets[0].bytes[468 + 93] = 0xFF;  // the last angle was not written
    has(faultOf(packets), "angles of the beams of the RoboSense Helios are not known");
    packets = described(toy, 1);
    packets[7] = test::robosenseDrive(test::robosenseToys()[3], 1)[0];
    has(faultOf(packets), "RoboSense Ruby Plus is among packets of a Helios");
    packets[7].bytes[0] = 0;
    has(faultOf(packets), "unknown RoboSense");
    packets = described(test::robosenseToys()[1], 1);
    packets[1].bytes[30] = 1;
    has(faultOf(packets), "RoboSense of type 1/0/0 are not supported");
    packets = described(toy, 0.2);
    has(faultOf(packets), "of 360 degrees in");
    EXPECT_EQ(faultOf({}), "");
}

TEST(PacketsRobosense, OfAPcap) {
    const TemporaryFolder folder;
    for (const bool isLate : {false, true}) {
        const RobosenseToy toy = test::robosenseToys()[0];
        test::PcapWriter writer;
        std::size_t count = 0;
        for (const auto& packet : test::robosenseDrive(toy, 2.2)) {
            if (count++ == (isLate ? 100U : 0U)) {
                writer.port = 7788;
                writer.from = 0xC0A801C8;  // another sensor's
                Bytes other = test::robosenseDescription(toy);
                other[468] = 0xFF;
                writer.add(other, packet.time_s);
                writer.from = 0xC0A801C9;
                writer.add(test::robosenseDescription(toy), packet.time_s);
            }
            writer.port = 6699;
            writer.add(packet.bytes, packet.time_s + 0.001);
        }
        writer.write((folder / "d.pcap").string());
        const auto reader = io::openScans((folder / "d.pcap").string());
        EXPECT_EQ(io::describe(reader->recording()),
                  "RoboSense Helios, 10 Hz, points with times, not de-skewed by the recorder "
                  "(pcap)");
        EXPECT_EQ(reader->label(), "robosense");
        std::size_t scans = 0;
        while (const auto scan = reader->next()) {
            expectPoints(*scan, toy);
            ++scans;
        }
        EXPECT_EQ(scans, 2U);
    }
}
}  // namespace
