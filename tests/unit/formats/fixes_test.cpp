
#include <gtest/gtest.h>

#include "delio/core/error.h"
#include "delio/formats/georeference.h"
#include "test_data.h"

namespace {
using namespace delio;

earth::Fixes read(const std::string& name, const std::string& text) {
    const test::TemporaryFolder folder;
    test::writeText(folder / name, text);
    return io::readFixes(folder / name);
}

std::string faultIn(const std::string& name, const std::string& text) {
    try {
        read(name, text);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Fixes, OfACsv) {
    const auto fixes = read("gnss.csv",
                            "# a comment\ntime,Latitude,longitude,height,sigma_east,sigma_north,"
                            "sigma_up\n1616513421.5,49.1,8.4,115.5,0.01,0.02,0.03\n"
                            "1616513422500,49.2,-8.4,,,,\n");
    ASSERT_EQ(fixes.size(), 2U);
    EXPECT_EQ(fixes[0].stamp_s, 1616513421.5);
    EXPECT_EQ(fixes[0].place.latitude_deg, 49.1);
    EXPECT_EQ(fixes[0].place.height_m, 115.5);
    EXPECT_DOUBLE_EQ(fixes[0].covariance(1, 1), 4e-4);
    EXPECT_DOUBLE_EQ(fixes[0].covariance(2, 2), 9e-4);
    EXPECT_EQ(fixes[1].stamp_s, 1616513422.5);  // milliseconds
    EXPECT_EQ(fixes[1].place.longitude_deg, -8.4);
    EXPECT_EQ(fixes[1].covariance(2, 2), 1e6);  // no height
    EXPECT_FALSE(fixes[1].antenna);
    const auto unknown =
        read("gnss.csv", "time,lat,lon,height,quality,sigma_up\n1,49,8,nan,nan,nan\n");
    ASSERT_EQ(unknown.size(), 1U);
    EXPECT_TRUE(earth::isUsable(unknown[0]));
    EXPECT_EQ(unknown[0].place.height_m, 0);
    EXPECT_EQ(unknown[0].covariance(2, 2), 1e6);
    EXPECT_NE(faultIn("gnss.csv", "1,2,3\n").find("line 1"), std::string::npos);
    EXPECT_NE(faultIn("gnss.csv", "time,lat,lon\n1,2,x\n").find("line 2"), std::string::npos);
    EXPECT_NE(faultIn("gnss.csv", "time,lat,lon\n1,2\n").find("line 2"), std::string::npos);
    EXPECT_TRUE(read("gnss.csv", "time,lat,lon\n").empty());
}

TEST(Fixes, OfNmea) {
    const std::string gga = "$GPGGA,123519.50,4807.038,N,01131.000,E,4,08,0.9,545.4,M,46.9,M,,*";
    unsigned sum = 0;
    for (const char c : gga.substr(1, gga.size() - 2)) sum ^= static_cast<unsigned char>(c);
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02X", sum);
    const auto fixes =
        read("gnss.nmea", gga + digits + "\r\n" + gga + "00\r\nnoise\n" +
                              "$GNRMC,123520,A,4807.038,N,01131.000,E,,,230394,,\n"
                              "$GNGGA,123520,4807.038,S,01131.000,W,1,08,2,10,M,,M,,\n"
                              "$GNGGA,123521,4807.038,S,01131.000,W,0,,,,M,,M,,\n"
                              "$GNGGA,,,,,,0,,,,M,,M,,\n");
    ASSERT_EQ(fixes.size(), 2U);
    EXPECT_NEAR(fixes[0].place.latitude_deg, 48.1173, 1e-9);
    EXPECT_NEAR(fixes[0].place.longitude_deg, 11.516666667, 1e-8);
    EXPECT_NEAR(fixes[0].place.height_m, 592.3, 1e-9);  // above the ellipsoid
    EXPECT_NEAR(fixes[0].covariance(0, 0), 0.018 * 0.018, 1e-9);
    EXPECT_NEAR(fixes[1].place.latitude_deg, -48.1173, 1e-9);
    EXPECT_NEAR(fixes[1].place.longitude_deg, -11.516666667, 1e-8);
    EXPECT_NEAR(fixes[1].covariance(0, 0), 36, 1e-9);
    // 2094-03-23 12:35:19.5 UTC, also where the date comes later.
    EXPECT_EQ(fixes[0].stamp_s, 3920186119.5);
    EXPECT_EQ(fixes[1].stamp_s, 3920186120);
    EXPECT_NE(faultIn("gnss.nmea", "hello\n$GPGGA,1\n").find("no NMEA fixes"), std::string::npos);
}

TEST(Fixes, OfNmeaWithoutDatesPassMidnight) {
    const auto fixes = read("gnss.nmea",
                            "$GPGGA,235959,4807.0,N,01131.0,E,1,08,1,5,M,0,M,,\n"
                            "$GPGGA,000001,4807.0,N,01131.0,E,1,08,1,5,M,0,M,,\n");
    ASSERT_EQ(fixes.size(), 2U);
    EXPECT_EQ(fixes[1].stamp_s - fixes[0].stamp_s, 2);
}

TEST(Fixes, AreUsableOnTheEarth) {
    earth::Fix fix;
    fix.place = {49, 8, 100};
    EXPECT_TRUE(earth::isUsable(fix));
    for (const earth::Geodetic place :
         {earth::Geodetic{0, 0, 0}, earth::Geodetic{91, 8, 0}, earth::Geodetic{49, 8, 1e7}}) {
        fix.place = place;
        EXPECT_FALSE(earth::isUsable(fix));
    }
    fix.place = {49, 8, 100};
    fix.covariance(1, 1) = -1;
    EXPECT_FALSE(earth::isUsable(fix));
}

TEST(GeoreferenceFile, GivesThePlaceBack) {
    const test::TemporaryFolder folder;
    earth::Georeference place;
    place.origin = {49.011, 8.4228, 112.8};
    place.enuFromMap.linear() =
        Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    place.covariance = 0.25 * Matrix6::Identity();
    const std::string path = folder / "georeference.yaml";
    io::writeGeoreference(place, {}, path);
    const auto again = io::readGeoreference(path);
    EXPECT_EQ(again.origin.latitude_deg, place.origin.latitude_deg);
    EXPECT_TRUE(again.enuFromMap.matrix() == place.enuFromMap.matrix());
    EXPECT_TRUE(again.covariance == place.covariance);
    for (const char* text : {"", "a: b\n", "origin: {latitude_deg: 1e9}\n", "- ["}) {
        test::writeText(path, text);
        EXPECT_THROW(io::readGeoreference(path), Error) << text;
    }
    EXPECT_THROW(io::readGeoreference(folder / "none.yaml"), Error);
}
}  // namespace
