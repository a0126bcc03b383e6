// What holds for every scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive.h"
#include "ray_caster.h"
#include "scene_support.h"
#include "test_data.h"
#include "tile_window.h"
#include "tunnel_scene.h"

namespace {
using namespace delio;
using namespace delio::synth;
constexpr double kDegree = 3.14159265358979323846 / 180;

/** Looks ahead from all over the vehicle's front, every `every` scans. */
void expectFreeWay(const Scene& scene, const Drive& drive, std::size_t every) {
    RayCaster caster;
    TileWindow window(scene, caster, 15);
    for (std::size_t i = 0; i + every < drive.scans(); i += every) {
        window.moveTo(drive.station(i));
        const auto pose = drive.lidarPose(i);
        const Eigen::Vector3d way = drive.lidarPose(i + every).translation() - pose.translation();
        if (way.norm() < 0.1) continue;
        const double reach = std::min(4.0, way.norm());
        std::vector<Hit> hits;
        for (const double side : {-1.0, -0.5, 0.0, 0.5, 1.0})
            for (const double below : {-1.4, -0.7, 0.0, 0.5}) {
                caster.cast(pose * Eigen::Vector3d(0, side, below), {pose.linear().col(0)}, reach,
                            hits);
                ASSERT_EQ(hits[0].range, 0) << "scan " << i << ", " << side << " m beside";
            }
        caster.cast(pose.translation(), {-pose.linear().col(2)}, 3, hits);
        ASSERT_NEAR(hits[0].range, drive.carrier().sensorHeight_m, 0.05) << "scan " << i;
    }
}

/** One ground, not two: straight down from above, all about the vehicle. */
void expectOneGround(const Scene& scene, const Drive& drive, std::size_t every) {
    RayCaster caster;
    TileWindow window(scene, caster, 15);
    const Road& road = scene.road();
    for (std::size_t i = 0; i < drive.scans(); i += every) {
        window.moveTo(drive.station(i));
        for (double side = -1.5; side <= 1.5; side += 0.5) {
            const Eigen::Vector2d place =
                road.point(drive.station(i) + 2.1, road.vehicleSide() + side);
            const double z = road.height(place);
            std::vector<Hit> hits;
            caster.cast({place.x(), place.y(), z + 1}, {-Eigen::Vector3d::UnitZ()}, 3, hits);
            ASSERT_NEAR(hits[0].range, 1, 0.012) << "scan " << i << ", " << side << " m beside";
            // From below: the same surface.
            caster.cast({place.x(), place.y(), z - 0.5}, {Eigen::Vector3d::UnitZ()}, 3, hits);
            ASSERT_NEAR(hits[0].range, 0.5, 0.012) << "scan " << i << ", " << side << " m beside";
        }
    }
}

struct SceneOf : testing::TestWithParam<std::string> {};
struct AnySceneOf : testing::TestWithParam<std::string> {};

TEST_P(SceneOf, LeavesTheRoadToTheVehicle) {
    const bool loop = GetParam() == "loop";
    const std::size_t scans = loop ? 1150 : 300;
    const auto scene = test::sceneOf(GetParam(), 2, scans);
    const Drive drive(scene->road(), scans, 2);
    ASSERT_EQ(drive.scans(), scans);
    expectFreeWay(*scene, drive, loop ? 10 : 4);
}

TEST_P(SceneOf, HasOneGround) {
    const auto scene = test::sceneOf(GetParam(), 3, 200);
    expectOneGround(*scene, Drive(scene->road(), 200, 3), 8);
}

TEST_P(AnySceneOf, BeginsAlikeHoweverLongTheDrive) {
    const auto brief = test::sceneOf(GetParam(), 5, 50),
               lengthy = test::sceneOf(GetParam(), 5, 900);
    const Drive a(brief->road(), 50, 5), b(lengthy->road(), 900, 5);
    for (std::size_t i = 0; i < 50; i += 7)
        EXPECT_TRUE(a.lidarPose(i).matrix() == b.lidarPose(i).matrix()) << i;
    for (const int index : {-3, 2, 5}) {
        const Mesh one = brief->tile(index), other = lengthy->tile(index);
        ASSERT_EQ(one.vertices().size(), other.vertices().size()) << index;
        for (std::size_t i = 0; i < one.vertices().size(); ++i)
            ASSERT_EQ(one.vertices()[i], other.vertices()[i]) << index;
    }
}

TEST_P(SceneOf, MovesLikeACar) {
    double fastest = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const auto scene = test::sceneOf(GetParam(), seed, 600);
        const Drive drive(scene->road(), 600, seed);
        double before = -1;
        for (std::size_t i = 1; i < drive.scans(); ++i) {
            const auto step = drive.lidarPose(i - 1).inverse() * drive.lidarPose(i);
            const double speed = step.translation().norm() / kScanPeriod_s;
            const double yaw = std::atan2(step(1, 0), step(0, 0)) / kDegree / kScanPeriod_s;
            ASSERT_LT(std::abs(yaw), 35.5) << "scan " << i;
            if (before >= 0) {
                ASSERT_LT(std::abs(speed - before), 0.5) << "scan " << i;
            }
            before = speed;
            fastest = std::max(fastest, speed);
            ASSERT_GT(drive.lidarPose(i)(2, 2), 0.98);
        }
    }
    EXPECT_GT(fastest, 8);
    EXPECT_LT(fastest, 33.1);
}

INSTANTIATE_TEST_SUITE_P(Synth, SceneOf,
                         testing::Values("urban", "rural", "highway", "loop", "tunnel", "portal"),
                         [](const auto& param) { return param.param; });
INSTANTIATE_TEST_SUITE_P(Synth, AnySceneOf, testing::ValuesIn(sceneNames()),
                         [](const auto& param) { return param.param; });

TEST(SynthForest, HasOneGround) {
    const auto scene = test::sceneOf("forest", 3, 200);
    expectOneGround(*scene, Drive(scene->road(), 200, 3), 4);
}

TEST(SynthHighway, IsDrivenFastFromTheStart) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto scene = test::sceneOf("highway", seed, 300);
        const Drive drive(scene->road(), 300, seed);
        for (std::size_t i = 1; i < drive.scans(); ++i) {
            const double speed = (drive.station(i) - drive.station(i - 1)) / kScanPeriod_s;
            ASSERT_GE(speed, 25) << "seed " << seed << ", scan " << i;
            ASSERT_LE(speed, 33.1) << "seed " << seed << ", scan " << i;
        }
        // What a scan's sweep needs from before the first one.
        EXPECT_LT(drive.stationAt(-0.05), -1.2);
    }
}

TEST(SynthDrive, StandsForSecondsOnStreets) {
    for (const std::string name : {"urban", "loop"}) {
        bool moving = false, standing = false;
        for (std::uint64_t seed = 1; seed < 7; ++seed) {
            const auto scene = test::sceneOf(name, seed, 900);
            const Drive drive(scene->road(), 900, seed);
            (drive.station(1) > 0.4 ? moving : standing) = true;
            std::size_t longest = 0, now = 0;
            for (std::size_t i = 20; i < drive.scans(); ++i) {
                const bool stands = drive.station(i) - drive.station(i - 1) < 1e-9;
                now = stands ? now + 1 : 0;
                longest = std::max(longest, now);
            }
            EXPECT_GE(longest, 20U) << name << ", seed " << seed;
            EXPECT_LE(longest, 80U) << name << ", seed " << seed;
        }
        EXPECT_TRUE(moving && standing) << name << ": the seed decides how the drive begins";
    }
}

TEST(SynthTunnel, ScansDoNotTellWhereInItOneIs) {
    const auto scene = test::sceneOf("tunnel", 1, 1200);
    const Drive drive(scene->road(), 1200, 1);
    RayCaster caster;
    TileWindow window(*scene, caster);
    std::vector<Eigen::Vector3d> local;
    for (int i = 0; i < 4000; ++i) {
        const double azimuth = 0.37 * i, elevation = (2 - 0.0066 * i) * kDegree;
        local.emplace_back(std::cos(elevation) * std::cos(azimuth),
                           std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    }
    std::vector<std::vector<Hit>> seen;
    for (const std::size_t scan : {0U, 1U, 403U, 1111U}) {
        const auto pose = drive.lidarPose(scan);
        window.moveTo(drive.station(scan));
        auto world = local;
        for (auto& direction : world) direction = pose.linear() * direction;
        seen.emplace_back();
        caster.cast(pose.translation(), world, 120, seen.back());
    }
    ASSERT_LT(drive.station(1111), TunnelScene::kEnd_m - 200);
    for (std::size_t i = 0; i < local.size(); ++i)
        for (std::size_t k = 1; k < seen.size(); ++k) {
            // Far along the tunnel a ray grazes: a hundredth of a millimetre of the wall is more.
            const double tolerance = 0.002 + 0.005 * seen[0][i].range / 120;
            ASSERT_NEAR(seen[0][i].range, seen[k][i].range, tolerance) << i << " at " << k;
            EXPECT_EQ(seen[0][i].reflectivity, seen[k][i].reflectivity);
        }
}
}  // namespace
