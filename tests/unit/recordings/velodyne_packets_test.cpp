#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include "spinner.h"

namespace {
using namespace delio;
using namespace delio::spinner_test;
using mrpt::maps::CPointsMapXYZI;
using Packet = CObservationVelodyneScan::TVelodyneRawPacket;

std::vector<std::size_t> pointsOfRings(const Scan& scan, std::size_t rings) {
    std::vector<std::size_t> counts(rings);
    for (const auto ring : scan.rings) ++counts.at(ring);
    return counts;
}

TEST(VelodynePackets, EveryReturnOfEveryLaserLiesOnItsWall) {
    for (const Spinner& spinner : {vlp16(), hdl32(), hdl64(M_PI / 180), hdl64(1)}) {
        const Scan scan = io::decodeObservation(spinner.scan());
        // A VLP-16 fires twice a shot, and so does no other.
        const auto perRing =
            static_cast<std::size_t>(spinner.shots()) * (spinner.lasers() == 16 ? 2 : 1);
        EXPECT_EQ(scan.points->size(), perRing * spinner.lasers());
        EXPECT_EQ(pointsOfRings(scan, spinner.lasers()),
                  std::vector<std::size_t>(spinner.lasers(), perRing));
        EXPECT_EQ(offTheWalls(scan), 0U) << spinner.lasers() << " lasers";
    }
}

TEST(VelodynePackets, ElevationsAndIntensitiesOfTheLasers) {
    const Spinner spinner = hdl32();
    const Scan scan = io::decodeObservation(spinner.scan());
    const auto* cloud = dynamic_cast<const CPointsMapXYZI*>(scan.points.get());
    ASSERT_TRUE(cloud);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
        float x = 0, y = 0, z = 0;
        cloud->getPoint(i, x, y, z);
        const auto& laser = spinner.calibration.laser_corrections[scan.rings[i]];
        EXPECT_NEAR(std::atan2(z, std::hypot(x, y)) * 180 / M_PI, laser.verticalCorrection, 1e-4);
        EXPECT_FLOAT_EQ(cloud->getPointIntensity(i), 8.0F * scan.rings[i] / 255.0F);
        if (HasFailure()) break;
    }
}

TEST(VelodynePackets, TimesRunFromTheFirstPacketOn) {
    auto packets = vlp16().scan();  // a packet, 12 blocks, a millisecond
    const Scan scan = io::decodeObservation(packets);
    ASSERT_EQ(scan.times_s.size(), scan.points->size());
    for (std::size_t i = 0; i < scan.times_s.size(); ++i)
        ASSERT_NEAR(scan.times_s[i], static_cast<double>(i / 32) * 1e-3 / 12, 1e-6) << i;

    // The clock begins anew with every hour.
    auto* bytes = reinterpret_cast<std::uint8_t*>(packets.scan_packets.data());
    for (std::size_t i = 0; i < packets.scan_packets.size(); ++i) {
        const auto time_us = static_cast<std::uint32_t>((3599998000 + i * 1000) % 3600000000);
        std::memcpy(bytes + i * sizeof(Packet) + 1200, &time_us, 4);
    }
    EXPECT_EQ(io::decodeObservation(packets).times_s, scan.times_s);

    // Packets that overtook each other, and a clock that is set in between.
    const auto stamp = [&](std::size_t i, std::uint32_t time_us) {
        std::memcpy(bytes + i * sizeof(Packet) + 1200, &time_us, 4);
    };
    for (std::size_t i = 0; i < packets.scan_packets.size(); ++i)
        stamp(i, static_cast<std::uint32_t>(i * 1000 + (i < 4 ? 0 : 500000000)));
    stamp(0, 1000);
    stamp(1, 0);
    const auto times_s = io::decodeObservation(packets).times_s;
    ASSERT_EQ(times_s.size(), scan.times_s.size());
    for (std::size_t i = 0; i < times_s.size(); ++i)
        ASSERT_NEAR(times_s[i], scan.times_s[i], 2.1e-3) << i;

    // A clock that stands tells nothing.
    for (std::size_t i = 0; i < packets.scan_packets.size(); ++i)
        std::memset(bytes + i * sizeof(Packet) + 1200, 0, 4);
    EXPECT_TRUE(io::decodeObservation(packets).times_s.empty());
}

TEST(VelodynePackets, ASecondReturnCountsWhereItIsAnother) {
    for (Spinner spinner : {vlp16(), hdl32()}) {
        spinner.dual = true;
        const Scan scan = io::decodeObservation(spinner.scan());
        const auto shots = static_cast<std::size_t>(spinner.shots());
        const std::size_t second = shots * (spinner.lasers() == 16 ? 2 : 1);
        EXPECT_EQ(scan.points->size(), 32 * shots + second);
        EXPECT_EQ(offTheWalls(scan), second);
    }
}

TEST(VelodynePackets, RangesOutOfBoundsAndUnknownBlocksAreLeftOut) {
    auto scan = vlp16().scan();
    auto* bytes = reinterpret_cast<std::uint8_t*>(scan.scan_packets.data());
    const auto points = [&] { return io::decodeObservation(scan).points->size(); };
    const std::size_t all = points();
    bytes[1] = 0;  // the header of the first block
    EXPECT_EQ(points(), all - 32);
    scan.minRange = 0;
    bytes[104] = bytes[105] = 0;  // the range of the second block's first return
    EXPECT_EQ(points(), all - 33);
    scan.minRange = 6.5;
    scan.maxRange = 7.5;
    const Scan ring = io::decodeObservation(scan);
    EXPECT_GT(ring.points->size(), 1000U);
    EXPECT_EQ(ring.rings.size(), ring.points->size());
    for (std::size_t i = 0; i < ring.points->size(); ++i) {
        float x = 0, y = 0, z = 0;
        ring.points->getPoint(i, x, y, z);
        EXPECT_NEAR(std::hypot(x, y, z), 7, 0.5001);
    }
    scan.scan_packets.clear();
    EXPECT_EQ(points(), 0U);
}

TEST(VelodynePackets, WithoutACalibrationThereIsOneError) {
    auto scan = vlp16().scan();
    scan.calibration.laser_corrections.resize(8);
    EXPECT_NE(faultOf(scan).find("8 lasers"), std::string::npos);
    scan.calibration.clear();
    EXPECT_NE(faultOf(scan).find("calibration"), std::string::npos);
}
}  // namespace
