// Wheel odometry beside a LiDAR: synth2rawlog records it, delio-slam uses it where the scans show
// no motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "command.h"
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

std::string drive(const std::string& rawlog, const std::string& scene, const std::string& scans,
                  const Words& more) {
    Words words = {"-o",      rawlog, "--scene", scene, "--sensor", "vlp16",
                   "--scans", scans,  "--seed",  "7",   "--start",  "moving"};
    words.insert(words.end(), more.begin(), more.end());
    const auto made = test::runTool("synth2rawlog", words);
    EXPECT_EQ(made.exitCode, 0) << made.err;
    return rawlog;
}

run::Summary slam(const std::string& rawlog, const std::string& out, const Words& more = {},
                  int exitCode = 0) {
    Words words = {"-i", rawlog, "-o", out, "--no-map", "--no-graph", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = test::runTool("delio-slam", words);
    EXPECT_EQ(run.exitCode, exitCode) << run.err;
    return run::RunFolder(out).summary();
}

std::string trajectoryOf(const std::string& folder) {
    return test::readText(folder + "/" + run::RunFolder::kTrajectory);
}

TEST(Wheels, CarryThePoseThroughASmoothTunnel) {
    const test::TemporaryFolder folder;
    const std::string rawlog =
        drive(folder / "tunnel.rawlog", "tunnel", "80", {"--odometry", "0.01"});
    const auto with = slam(rawlog, folder / "with");
    EXPECT_EQ(with.lost, 0U);
    EXPECT_GT(figure(with.odometry, "scans_carried"), 75);
    EXPECT_LT(figure(with.metrics, "end_error_percent"), 1.5);
    const auto without = slam(rawlog, folder / "without", {"--no-odometry"}, 1);
    EXPECT_TRUE(without.odometry.empty());
    EXPECT_GT(figure(without.metrics, "end_error_percent"), 50);
    slam(rawlog, folder / "one", {"--threads", "1"});
    EXPECT_TRUE(trajectoryOf(folder / "with") == trajectoryOf(folder / "one"));
}

TEST(Wheels, AreLearntOnTheRoadBeforeATunnel) {
    const test::TemporaryFolder folder;
    const auto with =
        slam(drive(folder / "d.rawlog", "portal", "180", {"--odometry", "0.05"}), folder / "with");
    EXPECT_GT(figure(with.odometry, "scans_carried"), 20);
    EXPECT_LT(figure(with.odometry, "scans_carried"), 100);
    EXPECT_NEAR(figure(with.odometry, "scale"), 1 / 1.05, 0.005);
    EXPECT_LT(figure(with.metrics, "end_error_percent"), 0.3);
}

TEST(Wheels, ThatSlipDoNotDisturbScansThatShowAllAxes) {
    const test::TemporaryFolder folder;
    const std::string rawlog = drive(folder / "street.rawlog", "urban", "120",
                                     {"--odometry", "0.01", "--slip", "6,3,0.1", "--distort"});
    const auto with = slam(rawlog, folder / "with"),
               without = slam(rawlog, folder / "without", {"--no-odometry"});
    EXPECT_NEAR(figure(with.odometry, "scale"), 1 / 1.01, 0.002);
    EXPECT_GT(figure(with.odometry, "stretches_off"), 5);
    EXPECT_LT(figure(with.odometry, "stretches_off"), 25);
    EXPECT_NEAR(figure(with.metrics, "end_error_m"), figure(without.metrics, "end_error_m"), 0.01);
}

TEST(Wheels, LeaveNoTraceInARawlogWithoutThem) {
    const test::TemporaryFolder folder;
    const std::string rawlog = drive(folder / "street.rawlog", "urban", "30", {});
    const auto with = slam(rawlog, folder / "with");
    EXPECT_TRUE(with.odometry.empty());
    slam(rawlog, folder / "without", {"--no-odometry"});
    EXPECT_TRUE(trajectoryOf(folder / "with") == trajectoryOf(folder / "without"));
    EXPECT_TRUE(test::readText(folder / "with/posegraph.g2o") ==
                test::readText(folder / "without/posegraph.g2o"));
}

TEST(Wheels, AreCopiedByScans2rawlog) {
    const test::TemporaryFolder folder;
    const std::string rawlog =
        drive(folder / "tunnel.rawlog", "tunnel", "40", {"--odometry", "0.01"});
    const auto copy = test::runTool("scans2rawlog", {"-i", rawlog, "-o", folder / "copy.rawlog"});
    ASSERT_EQ(copy.exitCode, 0) << copy.err;
    slam(rawlog, folder / "out");
    slam(folder / "copy.rawlog", folder / "of_copy");
    EXPECT_TRUE(trajectoryOf(folder / "out") == trajectoryOf(folder / "of_copy"));
}

TEST(Wheels, OptionsAreChecked) {
    const test::TemporaryFolder folder;
    for (const Words& wrong : {Words{"--odometry", "1"}, Words{"--slip", "1,1,0.1"},
                               Words{"--odometry", "0", "--slip", "1,1"},
                               Words{"--odometry", "0", "--slip", "1,-1,0.1"}}) {
        Words words = {"-o", folder / "d.rawlog", "--scene", "urban", "--scans", "1"};
        words.insert(words.end(), wrong.begin(), wrong.end());
        const auto made = test::runTool("synth2rawlog", words);
        EXPECT_EQ(made.exitCode, 2) << wrong.back();
        EXPECT_NE(made.err.find("--"), std::string::npos) << made.err;
    }
}
}  // namespace
