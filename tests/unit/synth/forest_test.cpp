#include "forest_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive.h"
#include "ray_caster.h"
#include "scene_support.h"
#include "tile_window.h"

namespace {
using namespace delio;
using namespace delio::synth;
using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kDegree = 3.14159265358979323846 / 180;

const ForestScene& forest(const Scene& scene) { return dynamic_cast<const ForestScene&>(scene); }

std::vector<ForestScene::Trunk> trunksOf(const Scene& scene, int first, int last) {
    std::vector<ForestScene::Trunk> all;
    for (int index = first; index <= last; ++index)
        for (const auto& trunk : forest(scene).trunks(index)) all.push_back(trunk);
    return all;
}

TEST(SynthForest, TrunksStandTwoToFiveMetresApart) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto scene = test::sceneOf("forest", seed, 300);
        const auto trunks = trunksOf(*scene, 0, 3);
        ASSERT_GT(trunks.size(), 400U);
        std::size_t lonely = 0;
        double thinnest = 1, thickest = 0;
        for (const auto& trunk : trunks) {
            double nearest = 1e3;
            for (const auto& other : trunks)
                if (&other != &trunk)
                    nearest = std::min(nearest, (other.place - trunk.place).norm());
            EXPECT_GE(nearest, 2);
            lonely += nearest > 5 ? 1 : 0;
            thinnest = std::min(thinnest, trunk.diameter_m);
            thickest = std::max(thickest, trunk.diameter_m);
            EXPECT_GT(scene->road().distance(trunk.place), 2.8);
        }
        EXPECT_LT(lonely, trunks.size() / 50);
        EXPECT_GE(thinnest, 0.15);
        EXPECT_LT(thinnest, 0.17);
        EXPECT_GT(thickest, 0.47);
        EXPECT_LE(thickest, 0.5);
    }
}

TEST(SynthForest, TrunksAreWhereAndAsThickAsTheyAreSaidToBe) {
    const auto scene = test::sceneOf("forest", 4, 300);
    RayCaster caster;
    caster.add(1, scene->tile(1));
    caster.commit();
    std::size_t seen = 0;
    const auto trunks = trunksOf(*scene, 1, 1);
    for (const auto& trunk : trunks) {
        const double z = scene->road().height(trunk.place) + 1.2;
        const Vector3d middle(trunk.place.x(), trunk.place.y(), z);
        std::vector<Hit> hits;
        double across = 1.2;
        for (const Vector3d& from : {Vector3d(-0.6, 0, 0), Vector3d(0.6, 0, 0)}) {
            caster.cast(middle + from, {-from.normalized()}, 1.2, hits);
            across -= hits[0].range > 0 ? hits[0].range : 1;
        }
        seen += std::abs(across - trunk.diameter_m) < 0.15 * trunk.diameter_m ? 1 : 0;
    }
    EXPECT_GT(static_cast<double>(seen), 0.85 * static_cast<double>(trunks.size()));
}

TEST(SynthForest, TheGroundHasBumpsOfFiveToFifteenCentimetres) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto scene = test::sceneOf("forest", seed, 300);
        const Road& road = scene->road();
        for (const double side : {0.0, 4.0, -7.0}) {
            // Off a line from one end of 6 m to the other.
            std::vector<double> bumps;
            for (double s = 0; s < 150; s += 3) {
                const auto height = [&](double at) {
                    return road.height(road.point(s + at, side));
                };
                double highest = -1, lowest = 1;
                for (double at = 0; at <= 6; at += 0.2) {
                    const double off = height(at) - height(0) - at / 6 * (height(6) - height(0));
                    highest = std::max(highest, off);
                    lowest = std::min(lowest, off);
                }
                bumps.push_back(highest - lowest);
            }
            std::nth_element(bumps.begin(), bumps.begin() + 25, bumps.end());
            EXPECT_GT(bumps[25], 0.05) << "seed " << seed << ", " << side;
            EXPECT_LT(bumps[25], 0.2) << "seed " << seed << ", " << side;
        }
    }
}

TEST(SynthForest, TheWayBetweenTheTreesIsFree) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const auto scene = test::sceneOf("forest", seed, 300);
        const Drive drive(scene->road(), 300, seed);
        RayCaster caster;
        TileWindow window(*scene, caster, 30);
        for (std::size_t i = 0; i + 5 < drive.scans(); i += 5) {
            window.moveTo(drive.station(i));
            const auto pose = drive.lidarPose(i);
            const Vector3d way = drive.lidarPose(i + 5).translation() - pose.translation();
            if (way.norm() < 0.1) continue;
            std::vector<Hit> hits;
            for (const double side : {-1.0, 0.0, 1.0})
                for (const double below : {-1.2, -0.6, 0.0, 0.5}) {
                    caster.cast(pose * Vector3d(0, side, below), {way.normalized()}, way.norm(),
                                hits);
                    ASSERT_EQ(hits[0].range, 0) << "seed " << seed << ", scan " << i;
                }
        }
    }
}

TEST(SynthForest, TheVehicleWindsAtTwoToFiveMetresASecond) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto scene = test::sceneOf("forest", seed, 400);
        const Drive drive(scene->road(), 400, seed);
        double turned = 0, steepest = 1;
        for (std::size_t i = 40; i < 400; ++i) {
            const double speed = (drive.station(i) - drive.station(i - 1)) / kScanPeriod_s;
            ASSERT_GT(speed, 2);
            ASSERT_LE(speed, 5.01);
            const auto step = drive.lidarPose(i - 1).inverse() * drive.lidarPose(i);
            const double yaw = std::atan2(step(1, 0), step(0, 0)) / kDegree;
            ASSERT_LT(std::abs(yaw) / kScanPeriod_s, 36);
            turned += std::abs(yaw);
            steepest = std::min(steepest, drive.lidarPose(i)(2, 2));
        }
        EXPECT_GT(turned, 90) << seed;
        EXPECT_GT(steepest, 0.94);
        EXPECT_LT(steepest, 0.998);  // it pitches and rolls over the bumps
    }
}
}  // namespace
