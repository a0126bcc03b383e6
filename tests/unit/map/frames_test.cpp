#include "delio/map/frames.h"

#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/map/map_point.h"
#include "point_support.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::pointAt;
using test::poseAtDeg;

/** A street, 20 m wide, with a wall and a few cars, level, z = 0. */
map::MapPoints street() {
    map::MapPoints points;
    for (int i = -50; i < 50; ++i)
        for (int j = -25; j < 25; ++j)
            points.push_back(pointAt(0.4 * i, 0.4 * j, 0.02 * ((i + 2 * j + 300) % 3 - 1)));
    for (int i = -50; i < 50; ++i)
        for (int k = 0; k < 20; ++k) points.push_back(pointAt(0.4 * i, 8, 0.3 * k));
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 5; ++j) points.push_back(pointAt(4 + 0.4 * i, 3 + 0.4 * j, 1.5));
    return points;
}

/** The street as a map that has it tilted, and the vehicle in that map. */
struct Tilted {
    Isometry3d mapFromLevel = poseAtDeg(3, -2, 1, 25, 8, -6);
    Isometry3d vehicle = mapFromLevel * poseAtDeg(1, 2, 1.7, 40);
    map::MapPoints points = street();
    Tilted() { map::move(points, mapFromLevel); }
};

TEST(GroundFrame, IsLevelOnTheGroundAndKeepsDirections) {
    const Tilted drive;
    const Isometry3d out = map::groundFrame(drive.points, drive.vehicle);
    const Isometry3d vehicle = out * drive.vehicle;
    EXPECT_NEAR(vehicle.translation().z(), 1.7, 0.02);
    EXPECT_NEAR(vehicle.translation().x(), drive.vehicle.translation().x(), 1e-9);
    EXPECT_NEAR(vehicle.translation().y(), drive.vehicle.translation().y(), 1e-9);
    const Vector3d up = out.linear() * drive.mapFromLevel.linear() * Vector3d::UnitZ();
    EXPECT_LT(std::acos(std::min(1.0, up.z())) * 180 / M_PI, 0.1);
    EXPECT_NEAR((out.linear() * Vector3d::UnitX()).y(), 0, 1e-12);
    EXPECT_GT((out.linear() * Vector3d::UnitX()).x(), 0.9);
    EXPECT_NEAR(out.linear().determinant(), 1, 1e-12);
    EXPECT_EQ(map::groundFrame(drive.points, drive.vehicle).matrix(), out.matrix());
}

TEST(GroundFrame, TakesTheGroundBelowAVehicleThatStandsOnIt) {
    // Its origin on the ground, as of some vehicles, not 1.7 m above it, as KITTI's.
    const Isometry3d out = map::groundFrame(street(), poseAtDeg(0, 0, 0, 0));
    EXPECT_LT((out.matrix() - Eigen::Matrix4d::Identity()).norm(), 0.02);
}

TEST(GroundFrame, NoGroundIsAnError) {
    map::MapPoints wall;
    for (int i = 0; i < 50; ++i)
        for (int k = 0; k < 50; ++k) wall.push_back(pointAt(0.1 * i, 3, 0.1 * k));
    for (const auto& points : {map::MapPoints{}, map::MapPoints(100), wall})
        EXPECT_THROW(map::groundFrame(points, poseAtDeg(0, 0, 1, 0)), Error);
    EXPECT_THROW(map::groundFrame(street(), poseAtDeg(500, 0, 1, 0)), Error);  // far from all
    EXPECT_THROW(map::groundFrame(street(), poseAtDeg(0, 0, -3, 0)), Error);   // a ceiling
}

TEST(EnuFrame, TurnsTheVehicleToItsHeading) {
    const Tilted drive;
    for (const double heading : {0.0, 90.0, 225.0, -30.0}) {
        const Isometry3d out = map::enuFrame(drive.points, drive.vehicle, heading);
        const Isometry3d vehicle = out * drive.vehicle;
        EXPECT_LT(vehicle.translation().norm(), 1e-9);
        const Vector3d forward = vehicle.linear() * Vector3d::UnitX();
        EXPECT_NEAR(forward.x(), std::sin(heading * M_PI / 180), 1e-4) << heading;
        EXPECT_NEAR(forward.y(), std::cos(heading * M_PI / 180), 1e-4) << heading;
        const Vector3d up = out.linear() * drive.mapFromLevel.linear() * Vector3d::UnitZ();
        EXPECT_LT(std::acos(std::min(1.0, up.z())) * 180 / M_PI, 0.1);
    }
}

/** WGS84 in closed form. */
Isometry3d ecefOf(double latitude_deg, double longitude_deg, double altitude) {
    constexpr double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double lat = latitude_deg * M_PI / 180, lon = longitude_deg * M_PI / 180;
    const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
    Isometry3d pose = Isometry3d::Identity();
    pose.translation() << (n + altitude) * std::cos(lat) * std::cos(lon),
        (n + altitude) * std::cos(lat) * std::sin(lon), (n * (1 - e2) + altitude) * std::sin(lat);
    pose.linear().col(0) << -std::sin(lon), std::cos(lon), 0;
    pose.linear().col(2) << std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon),
        std::sin(lat);
    pose.linear().col(1) = Vector3d(pose.linear().col(2)).cross(Vector3d(pose.linear().col(0)));
    return pose;
}

// Within 0.1 mm: MRPT's polar radius has as many digits.
TEST(EnuFrame, StandsOnTheEarthWhereItIsSaid) {
    // Known by heart: the equator at Greenwich, and the north pole.
    const auto origin = map::ecefFromEnu({0, 0, 0, 0});
    EXPECT_LT((origin.translation() - Vector3d(6378137, 0, 0)).norm(), 1e-6);
    EXPECT_LT((origin.linear() * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-12);
    EXPECT_LT((origin.linear() * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-12);
    EXPECT_NEAR(map::ecefFromEnu({90, 0, 0, 0}).translation().z(), 6356752.314245, 1e-4);
    for (const auto& [lat, lon, alt] :
         {std::tuple(49.011, 8.4228, 112.8), std::tuple(-33.86, 151.21, 5.0),
          std::tuple(36.84, -2.46, -3.0)}) {
        const auto found = map::ecefFromEnu({lat, lon, alt, 77});
        const auto expected = ecefOf(lat, lon, alt);
        EXPECT_LT((found.translation() - expected.translation()).norm(), 1e-4) << lat;
        EXPECT_LT((found.linear() - expected.linear()).norm(), 1e-12) << lat;
    }
}

TEST(FrameFile, HasEveryDigit) {
    const test::TemporaryFolder folder;
    const Isometry3d pose = poseAtDeg(1.0 / 3, -2e6 / 7, 3, 40, 5, 6);
    const map::GeoReference place{49.011, 8.4228, 112.8, 30};
    map::saveFrame(pose, place, folder / "a.frame.yaml");
    const auto yaml = mrpt::containers::yaml::FromFile(folder / "a.frame.yaml");
    const auto expectRows = [&](const char* name, const Isometry3d& expected) {
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                EXPECT_EQ(yaml[name](r)(c).as<double>(), expected.matrix()(r, c)) << name;
    };
    expectRows("transformation", pose);
    expectRows("ecef_from_enu", map::ecefFromEnu(place));
    EXPECT_EQ(yaml["origin"]["latitude_deg"].as<double>(), 49.011);
    EXPECT_EQ(yaml["origin"]["longitude_deg"].as<double>(), 8.4228);
    EXPECT_EQ(yaml["origin"]["altitude_m"].as<double>(), 112.8);
    map::saveFrame(pose, {}, folder / "b.frame.yaml");
    EXPECT_EQ(test::readText(folder / "b.frame.yaml").find("ecef"), std::string::npos);
}
}  // namespace
