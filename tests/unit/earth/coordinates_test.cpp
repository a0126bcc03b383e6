#include "delio/earth/coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "delio/core/geometry.h"
#include "delio/earth/georeference.h"

namespace {
using namespace delio;
using namespace delio::earth;

TEST(Coordinates, AreThoseOfProj) {
    // PROJ 9.1.1: echo "LON LAT" | cs2cs +proj=longlat +ellps=WGS84 +to +proj=utm +zone=Z
    struct Case {
        double latitude, longitude, easting, northing;
        UtmZone zone;
    };
    const Case kCases[] = {
        {49.011, 8.4228, 457791.5314, 5428839.0844, {32, true}},
        {-33.9, 151.2, 333568.9410, 6247473.3368, {56, false}},
        {60.4, 5.32, 297292.4353, 6701622.7424, {32, true}},
        {78.2, 15.6, 513696.9454, 8680760.0532, {33, true}},
        {0, -180, 166021.4431, 0.0000, {1, true}},
        {-0.001, 179.999, 833867.1282, 9999889.3173, {60, false}},
        {71, 25.78, 455672.1327, 7877843.0123, {35, true}},
    };
    for (const Case& each : kCases) {
        const Geodetic place{each.latitude, each.longitude, 5};
        const UtmZone zone = utmZoneOf(place);
        EXPECT_TRUE(zone == each.zone) << zone.name();
        const auto utm = utmOf(place, zone);
        EXPECT_NEAR(utm.x(), each.easting, 1e-4);
        EXPECT_NEAR(utm.y(), each.northing, 1e-4);
        EXPECT_EQ(utm.z(), 5);
    }
}

TEST(Coordinates, ComeBack) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Geodetic place{84 * unit(random), 180 * unit(random), 5000 * unit(random)};
        const auto near = [&](const Geodetic& other) {
            EXPECT_NEAR(other.latitude_deg, place.latitude_deg, 1e-11);
            EXPECT_NEAR(std::remainder(other.longitude_deg - place.longitude_deg, 360), 0, 1e-11);
            EXPECT_NEAR(other.height_m, place.height_m, 1e-7);
        };
        near(geodeticOf(ecefOf(place)));
        const UtmZone zone = utmZoneOf(place);
        near(geodeticOfUtm(utmOf(place, zone), zone));
        const EnuFrame enu({place.latitude_deg + 0.01, place.longitude_deg, 100});
        near(enu.geodeticOf(enu.enuOf(place)));
    }
}

TEST(Coordinates, AreEastNorthUp) {
    const Geodetic origin{49.011, 8.4228, 112.8};
    const EnuFrame enu(origin);
    EXPECT_LT(enu.enuOf(origin).norm(), 1e-9);
    EXPECT_NEAR(enu.enuOf({49.0111, 8.4228, 112.8}).y(), 11.12, 0.01);
    EXPECT_NEAR(enu.enuOf({49.011, 8.4229, 112.8}).x(), 7.317, 0.01);
    EXPECT_NEAR(enu.enuOf({49.011, 8.4228, 113.8}).z(), 1, 1e-9);
}

TEST(Coordinates, OfAMapBecomeUtm) {
    Georeference place;
    place.origin = {49.011, 8.4228, 112.8};
    place.enuFromMap = isometry(rotationExp({0, 0, 1}), {10, 20, 0});
    const MapToUtm utm(place);
    EXPECT_EQ(utm.zone().name(), "32N");
    EXPECT_EQ(utm.offset().z(), 0);
    const Eigen::Vector3d p(300, -200, 5);
    const Eigen::Vector3d truth = utmOf(place.geodeticOf(p), utm.zone());
    EXPECT_LT((utm(p) + utm.offset() - truth).norm(), 1e-6);
    // Directions turn as short ways do, and lengths shrink by no more than the scale.
    const Eigen::Vector3d way = utm(p + Eigen::Vector3d(1, 0, 0)) - utm(p);
    EXPECT_LT((way - utm.rotation().col(0)).norm(), 1e-3);
    EXPECT_NEAR(heading_deg(place.enuFromMap), 90 - 180 / M_PI, 1e-9);
}

TEST(Coordinates, NameTheirZone) {
    UtmZone zone;
    ASSERT_TRUE(zoneIn(wktOf({7, false}), zone));
    EXPECT_EQ(zone.name(), "7S");
    EXPECT_EQ(zone.epsg(), 32707);
    for (const char* wkt : {"", "UTM zone ", "UTM zone 99N", "UTM zone 0S", "UTM zone 32",
                            "UTM zone 99999999999N", "UTM zone 32X"})
        EXPECT_FALSE(zoneIn(wkt, zone)) << wkt;
}
}  // namespace
