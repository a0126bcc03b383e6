#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationRotatingScan.h>

#include "spinner.h"

namespace {
using namespace delio;
using namespace delio::spinner_test;
using mrpt::maps::CPointsMapXYZI;
using mrpt::obs::CObservationRotatingScan;

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
}  // namespace
