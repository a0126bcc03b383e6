// A gyroscope beside the LiDAR: synth2rawlog records one, delio-slam finds how it is mounted and
// uses it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using namespace delio;

using Words = std::vector<std::string>;

double figure(const run::Summary::Figures& figures, const std::string& name) {
    const auto found = std::find_if(figures.begin(), figures.end(),
                                    [&](const auto& each) { return each.first == name; });
    return found == figures.end() ? std::nan("") : found->second;
}

/** A hand that swings, and an IMU. */
std::string handWithImu(const test::TemporaryFolder& folder, const Words& imu,
                        const std::string& scans = "60") {
    const std::string rawlog = folder / "hand.rawlog";
    Words words = {"-o",        rawlog,  "--scene", "urban",  "--sensor", "vlp16",
                   "--scans",   scans,   "--seed",  "305",    "--motion", "handheld",
                   "--distort", "--imu", "200",     "--force"};
    words.insert(words.end(), imu.begin(), imu.end());
    const auto made = test::runTool("synth2rawlog", words);
    EXPECT_EQ(made.exitCode, 0) << made.err;
    return rawlog;
}

run::Summary slam(const std::string& rawlog, const std::string& out, Words more = {}) {
    Words words = {"-i", rawlog, "-o", out, "--no-map", "--no-graph", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = test::runTool("delio-slam", words);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    return run::RunFolder(out).summary();
}

TEST(Imu, OnTheLidarIsUsed) {
    const test::TemporaryFolder folder;
    const std::string rawlog = handWithImu(folder, {});
    const auto summary = slam(rawlog, folder / "out");
    EXPECT_EQ(summary.predicted, 0U);
    EXPECT_GT(figure(summary.imu, "scans_used"), 40);
    EXPECT_EQ(figure(summary.imu, "scans_without_samples"), 0);
    EXPECT_LT(figure(summary.metrics, "end_error_percent"), 0.5);
    const auto without = slam(rawlog, folder / "without", {"--no-imu"});
    EXPECT_TRUE(without.imu.empty());
    // The same scans without an IMU in the rawlog.
    const auto copy = test::runTool("scans2rawlog", {"-i", rawlog, "-o", folder / "copy.rawlog"});
    ASSERT_EQ(copy.exitCode, 0) << copy.err;
    slam(folder / "copy.rawlog", folder / "of_copy");
    const std::string trajectory = run::RunFolder::kTrajectory;
    EXPECT_TRUE(test::readText(folder / "out" / trajectory) ==
                test::readText(folder / "of_copy" / trajectory));
    EXPECT_FALSE(test::readText(folder / "out" / trajectory) ==
                 test::readText(folder / "without" / trajectory));
}

TEST(Imu, OfUnknownOrientationBiasAndOffsetIsCalibrated) {
    const test::TemporaryFolder folder;
    const std::string rawlog = handWithImu(
        folder, {"--imu-mount", "10,-20,130", "--imu-bias", "2", "--imu-offset", "0.02"}, "100");
    const auto summary = slam(rawlog, folder / "out");
    EXPECT_GT(figure(summary.imu, "scans_used"), 60);
    EXPECT_NEAR(figure(summary.imu, "roll_deg"), 10, 0.5);
    EXPECT_NEAR(figure(summary.imu, "pitch_deg"), -20, 0.5);
    EXPECT_NEAR(figure(summary.imu, "yaw_deg"), 130, 0.5);
    EXPECT_NEAR(figure(summary.imu, "offset_ms"), 20, 2);
    EXPECT_NEAR(std::abs(figure(summary.imu, "bias_z_deg_per_s")), 2, 0.2);
    EXPECT_LT(figure(summary.metrics, "end_error_percent"), 0.5);
}

TEST(Imu, ACalibratedOneIsUsedFromTheBeginningOfTheNextDrive) {
    const test::TemporaryFolder folder;
    const Words mounted = {"--imu-mount", "10,-20,130", "--imu-bias", "2", "--imu-offset", "0.05"};
    slam(handWithImu(folder, mounted, "100"), folder / "first");
    const std::string next = handWithImu(folder, mounted, "30");
    const auto unknown = slam(next, folder / "unknown");
    const Words given = {"--extrinsics", folder / "first/extrinsics.txt"};
    const auto known = slam(next, folder / "known", given);
    EXPECT_GE(figure(known.imu, "scans_used"), figure(unknown.imu, "scans_used") + 10);
    EXPECT_NEAR(figure(known.imu, "yaw_deg"), 130, 0.5);
    EXPECT_NEAR(figure(known.imu, "offset_ms"), 50, 2);
    EXPECT_LT(figure(known.metrics, "end_error_percent"), 0.5);
    EXPECT_NE(test::readText(folder / "known/extrinsics.txt").find("imu 0.00000"),
              std::string::npos);
    // A rawlog has the stamps of one clock.
    Words copy = {"-i", next, "-o", folder / "copy.rawlog"};
    copy.insert(copy.end(), given.begin(), given.end());
    EXPECT_EQ(test::runTool("scans2rawlog", copy).exitCode, 0);
    const auto copied = slam(folder / "copy.rawlog", folder / "of_copy");
    EXPECT_NEAR(figure(copied.imu, "offset_ms"), 0, 2);
    EXPECT_EQ(figure(copied.imu, "scans_used"), figure(known.imu, "scans_used"));
}

TEST(Imu, TheSameForAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    const std::string rawlog = handWithImu(folder, {"--imu-grade", "automotive"}, "30");
    slam(rawlog, folder / "one", {"--threads", "1"});
    slam(rawlog, folder / "four", {"--threads", "4"});
    const std::string trajectory = run::RunFolder::kTrajectory;
    EXPECT_TRUE(test::readText(folder / "one" / trajectory) ==
                test::readText(folder / "four" / trajectory));
}

TEST(Imu, LevelsTheMap) {
    const test::TemporaryFolder folder;
    const std::string rawlog = handWithImu(folder, {"--imu-grade", "automotive"});
    const auto tilted = slam(rawlog, folder / "tilted");
    const Eigen::Vector3d up(figure(tilted.imu, "up_x"), figure(tilted.imu, "up_y"),
                             figure(tilted.imu, "up_z"));
    // The world of the scene is level; its frame is turned as cam0's: y points down, x to the
    // right.
    const auto cam0 = io::readTrajectory(folder / "hand.origin.txt").poses.front();
    const Eigen::Vector3d down = cam0.linear().row(1).transpose();
    const Eigen::Vector3d truth = -Eigen::Vector3d(down.z(), -down.x(), -down.y());
    EXPECT_LT(std::acos(std::min(1.0, up.dot(truth))), 0.7 * M_PI / 180);
    EXPECT_GT(std::acos(std::min(1.0, truth.z())), 5 * M_PI / 180);
    const auto level = slam(rawlog, folder / "level", {"--level"});
    EXPECT_EQ(figure(level.imu, "up_z"), 1);
    const auto firstOf = [&](const std::string& name) {
        return io::readTrajectory(folder / (name + "/trajectory_kitti.txt")).poses.front();
    };
    const Eigen::Isometry3d upright = firstOf("level") * firstOf("tilted").inverse();
    EXPECT_NEAR((upright.linear() * up - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-6);
    EXPECT_NEAR(figure(level.metrics, "end_error_m"), figure(tilted.metrics, "end_error_m"), 1e-6);
}

TEST(Imu, LevellingNeedsAccelerations) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "plain.rawlog";
    const auto made = test::runTool(
        "synth2rawlog", {"-o", rawlog, "--scene", "urban", "--sensor", "vlp16", "--scans", "3"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const auto summary = slam(rawlog, folder / "out", {"--level"});
    const auto saysSo = [](const std::string& warning) {
        return warning.find("not levelled") != std::string::npos;
    };
    EXPECT_EQ(std::count_if(summary.warnings.begin(), summary.warnings.end(), saysSo), 1);
    for (const Words& wrong : {Words{"--no-imu"}, Words{"--map", "m.delio"}}) {
        Words words{"-i", rawlog, "-o", folder / "none", "--level"};
        words.insert(words.end(), wrong.begin(), wrong.end());
        EXPECT_EQ(test::runTool("delio-slam", words).exitCode, 2) << wrong.front();
    }
}

TEST(Imu, OptionsAreChecked) {
    const test::TemporaryFolder folder;
    for (const Words& wrong :
         {Words{"--imu", "0"}, Words{"--imu", "200", "--imu-grade", "toy"},
          Words{"--imu-bias", "1"}, Words{"--imu", "200", "--imu-mount", "1,2"},
          Words{"--imu", "200", "--imu-offset", "7"}}) {
        Words words = {"-o", folder / "d.rawlog", "--scene", "urban", "--scans", "1"};
        words.insert(words.end(), wrong.begin(), wrong.end());
        const auto made = test::runTool("synth2rawlog", words);
        EXPECT_EQ(made.exitCode, 2) << wrong.back();
        EXPECT_NE(made.err.find("imu"), std::string::npos) << made.err;
    }
}
}  // namespace
