#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive.h"
#include "echo.h"
#include "random.h"
#include "ray_caster.h"
#include "sensor_model.h"
#include "tile_window.h"
#include "urban_scene.h"

namespace {
using namespace delio::synth;
constexpr double kDegree = 3.14159265358979323846 / 180;

Road makeRoad(std::uint64_t seed, double length_m) { return Road(urbanPath(seed, length_m), seed); }

TEST(SynthRandom, DependsOnAllItsKeysAndIsUniformAndNormal) {
    EXPECT_EQ((Random{1, 2, 3}.next()), (Random{1, 2, 3}.next()));
    EXPECT_NE((Random{1, 2, 3}.next()), (Random{1, 3, 2}.next()));
    Random random{7};
    double sum = 0, normalSum = 0, normalSquares = 0;
    constexpr int kDraws = 20000;
    for (int i = 0; i < kDraws; ++i) {
        sum += random.uniform();
        const double n = random.normal();
        normalSum += n;
        normalSquares += n * n;
    }
    EXPECT_NEAR(sum / kDraws, 0.5, 0.01);
    EXPECT_NEAR(normalSum / kDraws, 0, 0.03);
    EXPECT_NEAR(normalSquares / kDraws, 1, 0.05);
}

TEST(SynthPath, CurvatureIsSmoothAndThePathNeverTurnsBack) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Path path = urbanPath(seed, 1500);
        EXPECT_GE(path.end(), 1500 + kPathMargin_m);
        double turned = 0;
        for (double s = 0; s < path.end() - 1; s += 1) {
            const auto here = path.at(s), next = path.at(s + 1);
            EXPECT_LT(std::abs(here.curvature), 1 / 13.0);
            EXPECT_LT(std::abs(next.curvature - here.curvature), 0.013) << "at " << s;
            EXPECT_NEAR(std::hypot(next.x - here.x, next.y - here.y), 1, 1e-3);
            EXPECT_GT(next.x, here.x);
            turned += std::abs(next.yaw - here.yaw);
        }
        EXPECT_GT(turned, 4 * 60 * kDegree);
    }
}

TEST(SynthPath, ALongerDriveBeginsLikeAShorterOne) {
    const Path brief = urbanPath(3, 100), lengthy = urbanPath(3, 2000);
    for (double s = -50; s < 150; s += 7) EXPECT_EQ(brief.at(s).y, lengthy.at(s).y);
}

TEST(SynthDrive, StartsFromStandstillAndTurnsLikeACar) {
    const Road road = makeRoad(1, 1500);
    const Drive drive(road, 600, 1);
    ASSERT_EQ(drive.scans(), 600U);
    EXPECT_EQ(drive.station(0), 0);
    double fastest = 0, quickestTurn = 0, mostTilt = 0;
    for (std::size_t i = 1; i < drive.scans(); ++i) {
        const auto step = drive.lidarPose(i - 1).inverse() * drive.lidarPose(i);
        const double speed = step.translation().norm() / kScanPeriod_s;
        if (i == 1) {
            EXPECT_LT(speed, 0.3);
        }
        fastest = std::max(fastest, speed);
        const double yaw = std::atan2(step(1, 0), step(0, 0)) / kDegree / kScanPeriod_s;
        quickestTurn = std::max(quickestTurn, std::abs(yaw));
        mostTilt = std::max(mostTilt, std::acos(std::min(1.0, step(2, 2))) / kDegree);
        const Eigen::Matrix3d R = drive.lidarPose(i).linear();
        EXPECT_NEAR((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
        EXPECT_NEAR(R.determinant(), 1, 1e-12);
    }
    EXPECT_GT(fastest, 8);
    EXPECT_LT(fastest, 12.1);
    EXPECT_GT(quickestTurn, 20);
    EXPECT_LT(quickestTurn, 35);
    EXPECT_GT(mostTilt, 0.05);
    EXPECT_LT(mostTilt, 1);
}

TEST(SynthScene, NothingReachesOverTheLanes) {
    const UrbanScene scene(makeRoad(2, 600), 2);
    const Road& road = scene.road();
    for (int index = 0; index < 12; ++index) {
        const Mesh mesh = scene.tile(index);
        for (std::size_t i = 0; i < mesh.vertices().size(); i += 5) {
            const Eigen::Vector3d v = mesh.vertices()[i].cast<double>();
            if (v.z() < road.height(v.head<2>()) + 0.2) continue;
            EXPECT_GT(road.distance(v.head<2>()), Road::kLaneEdge_m) << v.transpose();
        }
    }
}

TEST(SynthScene, ATileDependsOnSeedAndIndexAlone) {
    const UrbanScene one(makeRoad(5, 300), 5), longer(makeRoad(5, 900), 5);
    const Mesh a = one.tile(3), b = longer.tile(3);
    ASSERT_EQ(a.vertices().size(), b.vertices().size());
    for (std::size_t i = 0; i < a.vertices().size(); ++i)
        ASSERT_EQ(a.vertices()[i], b.vertices()[i]);
    EXPECT_NE(one.tile(4).vertices().size(), a.vertices().size());
}

TEST(SynthScene, OnlyTilesNearTheVehicleAreHeld) {
    const UrbanScene scene(makeRoad(1, 1000), 1);
    RayCaster caster;
    TileWindow window(scene, caster);
    for (const double s : {0.0, 300.0, 900.0}) {
        window.moveTo(s);
        EXPECT_LE(caster.ids().size(), 14U);
        // A street with corners leads 120 m straight from the vehicle in no less than that.
        EXPECT_LE(caster.ids().front() * Scene::kTileLength_m, s - 120);
        EXPECT_GE((caster.ids().back() + 1) * Scene::kTileLength_m, s + 120);
    }
}

TEST(SynthRayCaster, RangesAreExactFarFromTheOrigin) {
    Mesh wall;
    const Frame frame{{4000, 3000, 0}, {1, 0}, {0, 1}};
    wall.addQuad(frame.world(10, -20, -20), frame.world(10, 20, -20), frame.world(10, 20, 20),
                 frame.world(10, -20, 20), 0.5);
    RayCaster caster;
    caster.add(0, wall);
    caster.commit();
    const Eigen::Vector3d from(4000.012345, 3000.01, 0.5);
    const std::vector<Eigen::Vector3d> directions = {
        {1, 0, 0}, {0.8, 0.6, 0}, {-1, 0, 0}, {0.6, 0, 0.8}, {0, 1, 0}};
    std::vector<Hit> hits;
    caster.cast(from, directions, 120, hits);
    EXPECT_NEAR(hits[0].range, 9.987655, 1e-9);
    EXPECT_NEAR(hits[1].range, 9.987655 / 0.8, 1e-9);
    EXPECT_EQ(hits[2].range, 0);
    EXPECT_NEAR(hits[3].range, 9.987655 / 0.6, 1e-9);
    EXPECT_NEAR(hits[3].cosIncidence, 0.6, 1e-9);
    EXPECT_EQ(hits[4].range, 0);
}

TEST(SynthSensor, TheHdl64eHasTwoBlocksOfLasers) {
    const auto models = sensorModels();
    const auto model = std::find_if(models.begin(), models.end(),
                                    [](const auto& m) { return m.option == "hdl64e"; });
    ASSERT_NE(model, models.end());
    const auto& elevations = model->elevations_rad;
    ASSERT_EQ(elevations.size(), 64U);
    EXPECT_NEAR(elevations[0], 2 * kDegree, 1e-12);
    EXPECT_NEAR(elevations[31], -8.333333 * kDegree, 1e-6);
    EXPECT_NEAR(elevations[32], -8.83 * kDegree, 1e-12);
    EXPECT_NEAR(elevations[63], -24.33 * kDegree, 1e-12);
    EXPECT_TRUE(std::is_sorted(elevations.rbegin(), elevations.rend()));
    EXPECT_EQ(model->columns, 2083);
}

TEST(SynthScanner, FarGrazingAndDarkEchoesAreLostMore) {
    const Hit near{10, 0.5, 0.4}, far{110, 0.5, 0.4}, grazing{60, 0.03, 0.24}, pane{10, 0.5, 0.06};
    EXPECT_GT(detectionProbability(near), 0.95);
    EXPECT_GT(detectionProbability(far), 0.5);
    EXPECT_LT(detectionProbability(grazing), 0.6);
    EXPECT_LT(detectionProbability(pane), 0.2);
}
}  // namespace
