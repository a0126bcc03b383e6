// delio-slam: true poses and calibration beside a drive.
#include <gtest/gtest.h>

#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::DelioSlam;
using test::readText;
using test::Words;
using test::writeText;
using test::operator+;
namespace fs = std::filesystem;

TEST_F(DelioSlam, GroundTruth) {
    writeDrive(6);
    const fs::path truth = folder_ / "truth.txt";
    const std::string poses = readText(folder_ / "d.poses.txt");
    const auto with = [&](const std::string& text, const Words& more = {}) {
        writeText(truth, text);
        return slam(Words{"--ground-truth", truth, "--force"} + more);
    };
    std::string ofVehicle, tum;
    for (int i = 0; i < 6; ++i) {
        ofVehicle += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
        tum += std::to_string(0.1 * i) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
    }
    for (const auto& run : {with(poses), with(ofVehicle, {"--ground-truth-frame", "vehicle"}),
                            with(tum, {"--ground-truth-frame", "vehicle"})}) {
        EXPECT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.out.find("APE"), std::string::npos) << run.out;
    }
    EXPECT_LT(summary()["metrics"]["ape_m"].as<double>(), 0.3);

    // What cannot be right ends the run before it begins.
    fs::remove_all(out_);
    expectRefused(slam({"--ground-truth", folder_ / "none.txt"}), 1, {"none.txt"});
    expectRefused(with("1 2 3\n"), 1, {"truth.txt', line 1"});
    expectRefused(with(""), 1, {"truth.txt", "empty"});
    // What shows only later costs the evaluation, not the drive's results.
    for (const auto& run : {with(ofVehicle), with(poses, {"--ground-truth-frame", "vehicle"})}) {
        test::expectFailure(run, 1, {"--ground-truth-frame"});
        EXPECT_EQ(rows("trajectory_kitti.txt"), 6U);
        EXPECT_FALSE(summary().has("metrics"));
        EXPECT_TRUE(summary().has("fault"));
    }
    const std::string short_ = poses.substr(0, poses.find('\n') + 1);
    test::expectFailure(with(short_), 1, {"1 rows", "scan 5"});
    EXPECT_EQ(rows("trajectory_kitti.txt"), 6U);
    // The poses beside the rawlog were not asked for: a warning.
    writeText(folder_ / "d.poses.txt", short_);
    const auto beside = slam({"--force"});
    EXPECT_EQ(beside.exitCode, 0) << beside.err;
    EXPECT_NE(beside.err.find("no evaluation"), std::string::npos) << beside.err;
    EXPECT_EQ(summary()["warnings"].size(), 1U);
}

TEST_F(DelioSlam, ACalibrationWithoutTr) {
    writeDrive(3);
    const std::string poses = readText(folder_ / "d.poses.txt");
    writeText(folder_ / "d.calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    const auto run = slam();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("has no Tr"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(out_ / "trajectory_kitti_cam0.txt"));
    EXPECT_FALSE(summary().has("metrics"));
    EXPECT_EQ(summary()["warnings"].size(), 2U);  // also: no evaluation
    fs::remove_all(out_);
    expectRefused(slam({"--ground-truth", folder_ / "d.poses.txt"}), 1, {"Tr", "vehicle"});
    writeText(folder_ / "d.calib.txt", "Tr: 1 0 0 zero\n");
    expectRefused(slam(), 1, {"d.calib.txt', line 1", "zero"});
}

TEST_F(DelioSlam, AStandingVehicleHasNoRelativeErrors) {
    writeDrive(rawlog_, test::toyScans(3, 0.002));
    const std::string still = "1 0 0 0 0 1 0 0 0 0 1 0\n";
    writeText(folder_ / "d.poses.txt", still + still + still);
    const auto run = slam();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.out.find("nan"), std::string::npos) << run.out;
    EXPECT_EQ(readText(out_ / "summary.yaml").find("nan"), std::string::npos);
    EXPECT_LT(summary()["metrics"]["end_error_m"].as<double>(), 0.1);
}
}  // namespace
