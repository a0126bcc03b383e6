// Drives that come back to where they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "delio/core/error.h"
#include "delio/formats/trajectory.h"
#include "drive.h"
#include "poses.h"
#include "ray_caster.h"
#include "recording.h"
#include "scene_support.h"
#include "test_data.h"
#include "tile_window.h"

namespace {
using namespace delio;
using namespace delio::synth;

/** Places of the drive that are as near as `distance_m` in plan, but 30 s apart. */
struct Meeting {
    std::size_t early, late;
    double distance_m, turned;
};
std::vector<Meeting> meetings(const Drive& drive, double distance_m) {
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < drive.scans(); ++i) poses.push_back(drive.lidarPose(i));
    std::vector<Meeting> all;
    for (std::size_t i = 0; i < poses.size(); ++i)
        for (std::size_t j = i + 200; j < poses.size(); ++j) {
            const double d = (poses[i].translation() - poses[j].translation()).head<2>().norm();
            if (d > distance_m) continue;
            const double turned =
                std::remainder(test::yawOf(poses[j]) - test::yawOf(poses[i]), 2 * M_PI);
            all.push_back({i, j, d, std::abs(turned)});
        }
    return all;
}

TEST(SynthLoop, ComesBackInTheSameAndInTheOppositeDirection) {
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
        const auto scene = test::sceneOf("loop", seed, 1500);
        const Drive drive(scene->road(), 1500, seed);
        const Eigen::Isometry3d start = drive.lidarPose(0);
        double same = 1e9, opposite = 1e9;
        for (std::size_t i = 200; i < drive.scans(); ++i) {
            const Eigen::Isometry3d back = start.inverse() * drive.lidarPose(i);
            const double yaw = std::abs(test::yawOf(back));
            const double distance = back.translation().norm();
            if (yaw < 0.03) same = std::min(same, distance);
            if (yaw > M_PI - 0.03) opposite = std::min(opposite, distance);
        }
        EXPECT_LT(same, 1.0) << "seed " << seed;
        EXPECT_LT(opposite, 3.8) << "seed " << seed;  // on the other lane
        EXPECT_GT(opposite, 2.5) << "seed " << seed;
    }
}

TEST(SynthLoop, HeightsLineUp) {
    const auto scene = test::sceneOf("loop", 1, 1500);
    const Drive drive(scene->road(), 1500, 1);
    std::size_t compared = 0;
    for (const auto& meeting : meetings(drive, 0.05)) {
        if (meeting.turned > 0.01) continue;
        const auto a = drive.lidarPose(meeting.early), b = drive.lidarPose(meeting.late);
        // On a slope of some percent, that far apart.
        EXPECT_NEAR(a.translation().z(), b.translation().z(), 1e-3 + 0.06 * meeting.distance_m);
        ++compared;
    }
    EXPECT_GT(compared, 20U);
}

TEST(SynthLoop, TheTilesOfTheFirstRoundAreThereInTheSecond) {
    const auto scene = test::sceneOf("loop", 1, 1500);
    const Path& path = scene->road().path();
    // The drive's first street, from both sides.
    double again = 0;
    for (double s = 200; s < 600 && again == 0; s += 0.5)
        if (std::hypot(path.at(s).x - path.at(0).x, path.at(s).y - path.at(0).y) < 0.6) again = s;
    ASSERT_GT(again, 0);
    EXPECT_FALSE(scene->road().owns(again));
    const auto first = scene->tilesNear(0, 100), second = scene->tilesNear(again, 100);
    std::set<int> common;
    std::set_intersection(first.begin(), first.end(), second.begin(), second.end(),
                          std::inserter(common, common.end()));
    EXPECT_GE(common.size(), first.size() - 1);
    // However far one drives round, no more tiles are held.
    const auto longer = test::sceneOf("loop", 1, 6000);
    for (double s = 0; s < 4000; s += 500) EXPECT_LE(longer->tilesNear(s, 150).size(), 40U);
    EXPECT_TRUE(longer->tile(Scene::tileAt(again) + 1).triangles().empty());
}

class SynthRecording : public testing::Test {
 protected:
    std::string eight(double jitter_m) {
        test::writeEight(folder_ / "eight.txt", jitter_m);
        return folder_ / "eight.txt";
    }
    void expectRefused(const std::string& text, const std::string& part) {
        test::writeText(folder_ / "bad.txt", text);
        try {
            const Recording recording(folder_ / "bad.txt", test::kittiAxes());
            FAIL() << "taken: " << part;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find("bad.txt"), std::string::npos) << e.what();
        }
    }
    test::TemporaryFolder folder_;
};

/** At scan i the vehicle is where pose i is, and heads as it does. */
void expectOnTime(const Drive& drive, const std::string& file, double place_m, double yaw_deg) {
    const auto cam0 = io::readTrajectory(file).poses;
    ASSERT_EQ(drive.scans(), cam0.size());
    const auto Tr = test::kittiAxes();
    double before = -1e9;
    for (std::size_t i = 0; i < cam0.size(); ++i) {
        const Eigen::Isometry3d given = Tr.inverse() * cam0[i] * Tr;
        const auto made = drive.lidarPose(i);
        // The sensor stands on a ground that leans: its head is not above the wheels' middle.
        const Eigen::Vector2d foot =
            (made * Eigen::Vector3d(0, 0, -drive.carrier().sensorHeight_m)).head<2>();
        ASSERT_LT((foot - given.translation().head<2>()).norm(), place_m) << i;
        ASSERT_LT(std::abs(std::remainder(test::yawOf(made) - test::yawOf(given), 2 * M_PI)),
                  yaw_deg * M_PI / 180)
            << i;
        ASSERT_GE(drive.station(i), before);
        before = drive.station(i);
    }
}

TEST_F(SynthRecording, IsDrivenOnTimeAndCrossesItselfOnOneHeight) {
    const std::string file = eight(0.01);
    const auto scene = test::sceneOf("urban", 4, 100000, file);
    const Drive drive(scene->road(), 100000, 4);
    // Where the eight changes sides, the heading bends from one scan to the next.
    expectOnTime(drive, file, 0.06, 0.6);
    for (std::size_t i = 1; i < drive.scans(); ++i) {  // no kerb lies across the way
        const auto step = drive.lidarPose(i - 1).inverse() * drive.lidarPose(i);
        ASSERT_LT(std::acos(std::min(1.0, step(2, 2))), M_PI / 180) << i;
    }
    std::size_t compared = 0;
    for (const auto& meeting : meetings(drive, 0.1)) {
        const auto a = drive.lidarPose(meeting.early), b = drive.lidarPose(meeting.late);
        EXPECT_NEAR(a.translation().z(), b.translation().z(), 0.012);
        ++compared;
    }
    EXPECT_GT(compared, 30U);
    // The second time round, all is there already.
    const double round = 4 * M_PI * test::kEightRadius_m;
    EXPECT_TRUE(scene->road().owns(100));
    EXPECT_FALSE(scene->road().owns(round + 100));
}

TEST_F(SynthRecording, LeavesTheRoadToTheVehicle) {
    const std::string file = eight(0.01);
    for (const std::string name : {"urban", "rural"}) {
        const auto scene = test::sceneOf(name, 4, 900, file);
        const Drive drive(scene->road(), name == "urban" ? 900 : 500, 4);
        RayCaster caster;
        TileWindow window(*scene, caster, 15);
        for (std::size_t i = 0; i + 4 < drive.scans(); i += 4) {
            window.moveTo(drive.station(i));
            const auto pose = drive.lidarPose(i);
            std::vector<Hit> hits;
            for (const double side : {-1.0, 0.0, 1.0})
                for (const double below : {-1.4, -0.7, 0.5}) {
                    caster.cast(pose * Eigen::Vector3d(0, side, below), {pose.linear().col(0)}, 3,
                                hits);
                    ASSERT_EQ(hits[0].range, 0) << name << ", scan " << i << ", " << side;
                }
            caster.cast(pose.translation(), {-pose.linear().col(2)}, 3, hits);
            ASSERT_NEAR(hits[0].range, drive.carrier().sensorHeight_m, 0.05)
                << name << ", scan " << i;
        }
    }
}

TEST_F(SynthRecording, ADriveOfKittiIsDrivenOnTime) {
    DELIO_NEED_DATA("kitti/poses/07.txt");
    const std::string file = test::dataFolder() / "kitti/poses/07.txt";
    const auto scene = test::sceneOf("urban", 4, 100000, file);
    const Drive drive(scene->road(), 100000, 4);
    expectOnTime(drive, file, 0.08, 0.5);
    RayCaster caster;
    TileWindow window(*scene, caster, 15);
    for (std::size_t i = 0; i + 8 < drive.scans(); i += 8) {
        window.moveTo(drive.station(i));
        ASSERT_LE(scene->tilesNear(drive.station(i), TileWindow::kReach_m).size(), 30U);
        const auto pose = drive.lidarPose(i);
        std::vector<Hit> hits;
        for (const double side : {-1.0, 0.0, 1.0})
            for (const double below : {-1.4, -0.7, 0.5}) {
                caster.cast(pose * Eigen::Vector3d(0, side, below), {pose.linear().col(0)}, 3,
                            hits);
                ASSERT_EQ(hits[0].range, 0) << "scan " << i << ", " << side;
            }
    }
}

TEST_F(SynthRecording, AStandingVehicleStandsOnARoad) {
    std::string text;
    for (int i = 0; i < 30; ++i)
        text += "1 0 0 0.001 0 1 0 0 0 0 1 " + std::to_string(0.001 * (i % 3)) + "\n";
    test::writeText(folder_ / "still.txt", text);
    const auto scene = test::sceneOf("rural", 1, 30, folder_ / "still.txt");
    const Drive drive(scene->road(), 30, 1);
    EXPECT_EQ(drive.scans(), 30U);
    EXPECT_NEAR(drive.station(29), drive.station(0), 0.01);
    EXPECT_FALSE(scene->tile(0).triangles().empty());
}

TEST_F(SynthRecording, WhatNoVehicleDrivesIsRefused) {
    const std::string still = "1 0 0 0 0 1 0 0 0 0 1 0\n";
    expectRefused("", "empty");
    expectRefused(still, "one pose");
    expectRefused(still + "1 0 0 0 0 1 0 0 0 0 1 100\n", "100 m from the pose before");
    expectRefused(still + "1 0 0 0 0 1 0 0 0 0 1 nan\n", "line 2");
    expectRefused(still + "1 0 0 0 0 1 0 0 0 0 2 0\n", "not a rotation");
    expectRefused(still + "1 0 0 0 0 1 0 0 0 0 1\n", "line 2");
    expectRefused("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "KITTI poses");
    expectRefused(still + "-1 0 0 0 0 1 0 0 0 0 -1 0.1\n", "turned by 180 deg");
    std::string sideways;
    for (int i = 0; i < 20; ++i) sideways += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
    expectRefused(sideways, "sideways");
    EXPECT_THROW(Recording(folder_ / "none.txt", test::kittiAxes()), Error);
}

TEST_F(SynthRecording, AHighwayDoesNotTurnSharply) {
    io::Trajectory poses;
    for (int i = 0; i < 40; ++i) {
        const double angle = 0.05 * i, radius = 10;
        poses.poses.push_back(
            test::poseAt(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, angle));
    }
    const std::string file = folder_ / "sharp.txt";
    io::writeKitti(io::lidarToCam0(poses, test::kittiAxes()), file);
    EXPECT_NO_THROW(test::sceneOf("urban", 1, 40, file));
    EXPECT_THROW(test::sceneOf("highway", 1, 40, file), Error);
}
}  // namespace
