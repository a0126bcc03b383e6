#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "pcap_writer.h"
#include "recordings/packet_decoder.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
constexpr double kBegin_s = 1700000000;  // 13 min 20 s past the hour

int distanceOf(std::size_t laser, int azimuth, bool isSecond) {
    return 2000 + 10 * static_cast<int>(laser) + azimuth / 100 + (isSecond ? 300 : 0);
}

/** A packet with three firings of all lasers, or with one and both its returns. */
Bytes packetOf(std::size_t firing, bool isDual, std::uint32_t clock_us) {
    constexpr std::uint8_t kMarks[] = {0xEE, 0xDD, 0xCC, 0xBB};
    Bytes packet(1206);
    for (std::size_t b = 0; b < (isDual ? 8U : 12U); ++b) {
        const std::size_t bank = isDual ? b / 2 : b % 4, at = 100 * b;
        const auto azimuth =
            static_cast<std::uint16_t>(20 * (firing + (isDual ? 0 : b / 4)) % 36000);
        packet[at] = 0xFF;
        packet[at + 1] = kMarks[bank];
        test::putAt(packet, at + 2, azimuth);
        for (std::size_t k = 0; k < 32; ++k) {
            const std::size_t laser = 32 * bank + k;
            // Laser 5 has one return only.
            const bool isSecond = isDual && b % 2 == 1 && laser != 5;
            test::putAt(packet, at + 4 + 3 * k,
                        static_cast<std::uint16_t>(distanceOf(laser, azimuth, isSecond)));
            packet[at + 6 + 3 * k] = static_cast<std::uint8_t>(laser);
        }
    }
    test::putAt(packet, 1200, clock_us);
    packet[1204] = isDual ? 0x39 : 0x37;
    packet[1205] = 0xA1;
    return packet;
}

std::vector<Scan> scansOf(bool isDual, const std::string& angles) {
    const auto decoder = io::velodyneDecoder(angles);
    const std::size_t step = isDual ? 1 : 3;
    for (std::size_t firing = 0; firing < 2 * 1800; firing += step) {
        const double after_us = 53.3 * static_cast<double>(firing);
        const Bytes packet =
            packetOf(firing, isDual, 800'000'000U + static_cast<std::uint32_t>(after_us));
        decoder->add(packet.data(), packet.size(), kBegin_s + 1e-6 * after_us);
    }
    decoder->finish();
    EXPECT_EQ(decoder->sensor(), "Velodyne VLS-128");
    EXPECT_TRUE(decoder->findings().empty());
    std::vector<Scan> scans;
    while (auto scan = decoder->take()) scans.push_back(std::move(*scan));
    return scans;
}

TEST(PacketsVls128, PointsRingsAndTimes) {
    const test::TemporaryFolder folder;
    std::string table;
    const auto elevation = [](std::size_t laser) {
        return -15 + 0.25 * static_cast<double>(laser);
    };
    for (std::size_t laser = 0; laser < 128; ++laser)
        table += std::to_string(elevation(laser)) + " " + std::to_string(laser % 8) + "\n";
    test::writeText(folder / "angles.csv", table);
    const auto scans = scansOf(false, (folder / "angles.csv").string());
    ASSERT_EQ(scans.size(), 2U);
    for (const Scan& scan : scans) {
        ASSERT_EQ(scan.points->size(), 1800U * 128);
        for (std::size_t i = 0; i < scan.points->size(); ++i) {
            const std::size_t firing = i / 128, laser = i % 128;
            const int azimuth = 20 * static_cast<int>(firing);
            const double after_us = 2.665 * static_cast<double>(laser / 8 + laser / 64);
            const double turned =
                (0.01 * azimuth + 0.2 * after_us / 53.3 + static_cast<double>(laser % 8)) * M_PI /
                180;
            const double up = elevation(laser) * M_PI / 180;
            const double range = 0.004 * distanceOf(laser, azimuth, false);
            float x = 0, y = 0, z = 0;
            scan.points->getPoint(i, x, y, z);
            ASSERT_NEAR(x, range * std::cos(up) * std::cos(turned), 1e-4) << i;
            ASSERT_NEAR(y, -range * std::cos(up) * std::sin(turned), 1e-4) << i;
            ASSERT_NEAR(z, range * std::sin(up), 1e-4) << i;
            ASSERT_EQ(scan.rings[i], laser);
            ASSERT_NEAR(scan.times_s[i], 1e-6 * (53.3 * static_cast<double>(firing) + after_us),
                        3e-6);
        }
    }
    EXPECT_NEAR(scans[0].stamp_s, kBegin_s - 8.7e-6, 1e-6);
}

TEST(PacketsVls128, BothReturns) {
    const auto scans = scansOf(true, "");
    ASSERT_EQ(scans.size(), 2U);
    EXPECT_EQ(scans[0].points->size(), 1800U * 255);
}

TEST(PacketsVls128, IsToldFromOthersByItsBanks) {
    Bytes packet = packetOf(0, false, 0);
    for (const int byte : {0xA1, 0x63, 0x22, 0x00}) {
        packet[1205] = static_cast<std::uint8_t>(byte);
        const auto decoder = io::velodyneDecoder("");
        EXPECT_TRUE(decoder->add(packet.data(), packet.size(), kBegin_s));
        EXPECT_EQ(decoder->sensor(), "Velodyne VLS-128");
        EXPECT_THROW(decoder->finish(), Error);
    }
    const auto decoder = io::velodyneDecoder("");
    decoder->add(packet.data(), packet.size(), kBegin_s);
    for (std::size_t b = 0; b < 12; ++b) packet[100 * b + 1] = 0xEE;
    packet[1205] = 0x22;
    EXPECT_THROW(decoder->add(packet.data(), packet.size(), kBegin_s), Error);
    const auto other = io::velodyneDecoder("");
    other->add(packet.data(), packet.size(), kBegin_s);
    packet = packetOf(0, false, 0);
    EXPECT_THROW(other->add(packet.data(), packet.size(), kBegin_s), Error);
}
}  // namespace
