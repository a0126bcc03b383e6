#include "delio/io/decode_observation.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstring>

#include "delio/error.h"

namespace {
using namespace delio;
using mrpt::maps::CPointsMapXYZI;
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationRotatingScan;
using mrpt::obs::CObservationVelodyneScan;
using mrpt::obs::VelodyneCalibration;
using Packet = CObservationVelodyneScan::TVelodyneRawPacket;

/** Walls about the sensor, at another distance on each side: no mirrored azimuth fits. */
constexpr double kFront = 8, kBack = -6, kLeft = 9, kRight = -5;

double distanceFromWalls(float x, float y) {
    const double X = static_cast<double>(x), Y = static_cast<double>(y);
    return std::min(std::min(std::abs(X - kFront), std::abs(X - kBack)),
                    std::min(std::abs(Y - kLeft), std::abs(Y - kRight)));
}

double rangeToWalls(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
    const double x = ((ray.x() > 0 ? kFront : kBack) - from.x()) / ray.x();
    const double y = ((ray.y() > 0 ? kLeft : kRight) - from.y()) / ray.y();
    return std::min(std::abs(x), std::abs(y));
}

/** A sensor that turns evenly between the walls, `turn` hundredths of a degree a shot. */
struct Spinner {
    VelodyneCalibration calibration;
    int turn = 40;
    bool dual = false;  //!< the returns twice; laser 3's second one is 1 m behind the wall
    double angleUnit = M_PI / 180;  //!< of the calibration's azimuth corrections

    std::size_t lasers() const { return calibration.laser_corrections.size(); }
    int shots() const { return 36000 / turn; }

    /** Part of the turn to the next shot at which return `k` of a block fires. */
    double share(int k) const {
        if (lasers() == 16) return (k / 16 * 55.296 + k % 16 * 2.304) / 110.592;
        return lasers() == 32 ? k * 1.152 / 46.08 : 0;
    }

    double range(std::size_t laser, double turned_deg) const {
        const auto& c = calibration.laser_corrections[laser];
        const double azimuth = turned_deg * M_PI / 180 - angleUnit * c.azimuthCorrection;
        const Eigen::Vector3d ahead(std::cos(azimuth), -std::sin(azimuth), 0);
        const Eigen::Vector3d left(std::sin(azimuth), std::cos(azimuth), 0), up(0, 0, 1);
        const Eigen::Vector3d ray = c.cosVertCorrection * ahead + c.sinVertCorrection * up;
        const Eigen::Vector3d across = c.cosVertCorrection * up - c.sinVertCorrection * ahead;
        return rangeToWalls(
            c.horizontalOffsetCorrection * left + c.verticalOffsetCorrection * across, ray);
    }

    CObservationVelodyneScan scan() const {
        CObservationVelodyneScan scan;
        scan.calibration = calibration;
        scan.minRange = 0.5;
        std::vector<std::array<std::uint8_t, 100>> blocks;
        for (int shot = 0; shot < shots(); ++shot)
            for (int part = 0; part < (lasers() == 64 || dual ? 2 : 1); ++part)
                blocks.push_back(block(shot, part));
        scan.scan_packets.resize(blocks.size() / 12);
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            auto* packet = reinterpret_cast<std::uint8_t*>(&scan.scan_packets[i / 12]);
            std::memcpy(packet + i % 12 * 100, blocks[i].data(), 100);
            const auto time_us = static_cast<std::uint32_t>(i / 12 * 1000);
            std::memcpy(packet + 1200, &time_us, 4);
            packet[1204] = dual ? 0x39 : 0x37;
            packet[1205] = lasers() == 16 ? 0x22 : lasers() == 32 ? 0x21 : 0;
        }
        return scan;
    }

    std::array<std::uint8_t, 100> block(int shot, int part) const {
        const bool lower = lasers() == 64 && part == 1;
        std::array<std::uint8_t, 100> bytes{};
        const std::uint16_t header = lower ? 0xDDFF : 0xEEFF;
        const auto rotation = static_cast<std::uint16_t>(shot * turn);
        std::memcpy(bytes.data(), &header, 2);
        std::memcpy(&bytes[2], &rotation, 2);
        for (int k = 0; k < 32; ++k) {
            const std::size_t laser =
                static_cast<std::size_t>(k) % std::min<std::size_t>(32, lasers()) +
                (lower ? 32 : 0);
            const double behind = dual && part == 1 && laser == 3 ? 1 : 0;
            const double metres = range(laser, 0.01 * (shot + share(k)) * turn) + behind;
            const auto units = static_cast<std::uint16_t>(std::lround(metres / 0.002));
            std::memcpy(&bytes[4 + 3 * static_cast<std::size_t>(k)], &units, 2);
            bytes[6 + 3 * static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(8 * k);
        }
        return bytes;
    }
};

Spinner vlp16() { return {VelodyneCalibration::LoadDefaultCalibration("VLP16"), 40}; }
Spinner hdl32() { return {VelodyneCalibration::LoadDefaultCalibration("HDL32"), 15}; }

/** Lasers with offsets and corrections as an HDL-64E has them; angles in `unit` radians. */
Spinner hdl64(double unit) {
    Spinner spinner;
    spinner.turn = 24;
    spinner.angleUnit = unit;
    for (int i = 0; i < 64; ++i) {
        VelodyneCalibration::PerLaserCalib laser;
        const double elevation = (2 - 0.41 * i) * M_PI / 180;
        laser.verticalCorrection = elevation / unit;
        laser.sinVertCorrection = std::sin(elevation);
        laser.cosVertCorrection = std::cos(elevation);
        laser.azimuthCorrection = (i % 4 * 2.5 - 4) * M_PI / 180 / unit;
        laser.horizontalOffsetCorrection = i % 2 ? 0.026 : -0.026;
        laser.verticalOffsetCorrection = 0.2;
        spinner.calibration.laser_corrections.push_back(laser);
    }
    return spinner;
}

/** Points that are farther than 2 mm (the unit of ranges) from every wall. */
std::size_t offTheWalls(const Scan& scan) {
    std::size_t off = 0;
    for (std::size_t i = 0; i < scan.points->size(); ++i) {
        float x = 0, y = 0, z = 0;
        scan.points->getPoint(i, x, y, z);
        off += distanceFromWalls(x, y) > 0.002;
    }
    return off;
}

std::vector<std::size_t> pointsOfRings(const Scan& scan, std::size_t rings) {
    std::vector<std::size_t> counts(rings);
    for (const auto ring : scan.rings) ++counts.at(ring);
    return counts;
}

std::string faultOf(const mrpt::obs::CObservation& observation) {
    try {
        io::decodeObservation(observation);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
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

TEST(RotatingScan, ImagesThatMrptMakesOfPacketsKeepTheWallsStraight) {
    // 200 and more packets make an image of more than 65535 columns.
    for (Spinner spinner : {vlp16(), hdl32()})
        for (const bool dual : {false, true}) {
            spinner.dual = dual;
            CObservationRotatingScan image;
            image.fromVelodyne(spinner.scan());
            const Scan scan = io::decodeObservation(image);
            // MRPT 2.5.8 stores the first 16 returns of a block.
            const auto shots = static_cast<std::size_t>(spinner.shots());
            EXPECT_EQ(scan.points->size(), 16 * shots);
            EXPECT_EQ(scan.rings.size(), scan.points->size());
            EXPECT_EQ(offTheWalls(scan), dual ? shots : 0) << spinner.lasers() << " lasers";
            EXPECT_TRUE(std::dynamic_pointer_cast<CPointsMapXYZI>(scan.points));
        }
}

/** Sixteen rows and four columns, a quarter of a turn each; all at 10 m. */
CObservationRotatingScan cross() {
    CObservationRotatingScan scan;
    scan.rowCount = 16;
    scan.columnCount = 4;
    scan.rangeResolution = 0.01;
    scan.startAzimuth = 0;
    scan.azimuthSpan = 2 * M_PI;
    scan.rangeImage.setZero(16, 4);
    scan.rangeImage.fill(1000);
    return scan;
}

TEST(RotatingScan, TurnsTheWayItsSpanSays) {
    const auto& lasers = VelodyneCalibration::LoadDefaultCalibration("VLP16").laser_corrections;
    for (const double sign : {1.0, -1.0}) {
        auto image = cross();
        image.azimuthSpan *= sign;
        const Scan scan = io::decodeObservation(image);
        ASSERT_EQ(scan.points->size(), 64U);
        EXPECT_FALSE(std::dynamic_pointer_cast<CPointsMapXYZI>(scan.points));
        for (std::size_t i = 0; i < 64; ++i) {
            float x = 0, y = 0, z = 0;
            scan.points->getPoint(i, x, y, z);
            EXPECT_EQ(scan.rings[i], i / 4);
            const double elevation = lasers[i / 4].verticalCorrection * M_PI / 180;
            const double azimuth = sign * M_PI / 2 * static_cast<double>(i % 4);
            EXPECT_NEAR(x, 10 * std::cos(elevation) * std::cos(azimuth), 1e-5);
            EXPECT_NEAR(y, 10 * std::cos(elevation) * std::sin(azimuth), 1e-5);
            EXPECT_NEAR(z, 10 * std::sin(elevation), 1e-5);
        }
    }
}

TEST(RotatingScan, TimesFollowTheColumnsWhereTheSweepsDurationIsKnown) {
    auto image = cross();
    EXPECT_TRUE(io::decodeObservation(image).times_s.empty());
    image.sweepDuration = 0.1;
    const Scan scan = io::decodeObservation(image);
    ASSERT_EQ(scan.times_s.size(), 64U);
    for (std::size_t i = 0; i < 64; ++i)
        EXPECT_FLOAT_EQ(scan.times_s[i], 0.025F * static_cast<float>(i % 4));
}

TEST(RotatingScan, IntensitiesAndMissingReturns) {
    auto image = cross();
    image.intensityImage.setZero(16, 4);
    image.intensityImage(2, 1) = 51;
    image.minRange = 0;
    image.rangeImage(0, 0) = 0;
    image.rangeImage(0, 1) = 14000;
    const Scan scan = io::decodeObservation(image);
    ASSERT_EQ(scan.points->size(), 62U);
    const auto* cloud = dynamic_cast<const CPointsMapXYZI*>(scan.points.get());
    ASSERT_TRUE(cloud);
    for (std::size_t i = 0; i < 62; ++i)
        EXPECT_FLOAT_EQ(cloud->getPointIntensity(i), i == 2 * 4 + 1 - 2 ? 0.2F : 0.0F);
}

TEST(RotatingScan, RefusesImagesThatDoNotFit) {
    auto image = cross();
    image.rowCount = 15;
    EXPECT_NE(faultOf(image).find("15 rows"), std::string::npos);
    image = cross();
    image.intensityImage.setZero(16, 5);
    EXPECT_NE(faultOf(image).find("16 x 5"), std::string::npos);
    image = cross();
    image.rowCount = 64;
    image.rangeImage.setZero(64, 4);
    EXPECT_NE(faultOf(image).find("elevation"), std::string::npos);
    image.rangeImage.setZero(0, 0);
    EXPECT_EQ(faultOf(image), "");
    EXPECT_EQ(io::decodeObservation(image).points->size(), 0U);
}

TEST(DepthCamera, ARangeImageAloneIsProjected) {
    CObservation3DRangeScan camera;
    camera.hasRangeImage = true;
    camera.range_is_depth = true;
    camera.rangeUnits = 0.001F;
    camera.rangeImage_setSize(3, 4);
    camera.rangeImage.fill(0);
    camera.rangeImage(0, 3) = 4000;
    camera.rangeImage(2, 0) = 5000;
    camera.cameraParams.ncols = 4;
    camera.cameraParams.nrows = 3;
    camera.cameraParams.setIntrinsicParamsFromValues(2, 2, 1, 1);
    const auto points = io::decodeObservation(camera).points;
    ASSERT_EQ(points->size(), 2U);
    const float expected[2][3] = {{4, -4, 2}, {5, 2.5F, -2.5F}};
    for (std::size_t i = 0; i < 2; ++i) {
        float x = 0, y = 0, z = 0;
        points->getPoint(i, x, y, z);
        EXPECT_NEAR(x, expected[i][0], 1e-5);
        EXPECT_NEAR(y, expected[i][1], 1e-5);
        EXPECT_NEAR(z, expected[i][2], 1e-5);
    }
}
}  // namespace
