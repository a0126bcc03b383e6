// Two LiDARs of which each sees a half do as well as one that sees all.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "split_drive.h"

namespace {
using namespace delio;
using test::operator+;
namespace fs = std::filesystem;

class SeveralLidars : public test::DelioSlam {
 protected:
    void SetUp() override {
        const auto made = test::runTool(
            "synth2rawlog", {"-o", rawlog_, "--scene", "urban", "--sensor", "vlp16", "--scans",
                             "60", "--seed", "4", "--start", "moving", "--distort"});
        ASSERT_EQ(made.exitCode, 0) << made.err;
    }
    test::CommandResult run(const std::string& input, const std::string& name,
                            const test::Words& more = {}) const {
        return test::runTool("delio-slam",
                             test::Words{"-i", input, "-o", folder_ / name, "--no-map"} + more);
    }
    double endError(const std::string& name) const {
        for (const auto& [metric, value] : run::RunFolder(folder_ / name).summary().metrics)
            if (metric == "end_error_percent") return value;
        return 100;
    }
    const std::string halves_ = folder_ / "halves.rawlog";
};

TEST_F(SeveralLidars, TwoHalvesAreAsGoodAsOneWhole) {
    test::splitDrive(rawlog_, halves_);
    ASSERT_EQ(run(rawlog_, "whole").exitCode, 0);
    const auto merged = run(halves_, "merged", {"--sensor-label", "left,right", "--threads", "1"});
    ASSERT_EQ(merged.exitCode, 0) << merged.err;
    EXPECT_NE(merged.err.find("merged sensors left,right"), std::string::npos) << merged.err;
    EXPECT_LT(endError("merged"), std::max(1.1 * endError("whole"), 0.1));
    const auto half = run(halves_, "half");
    ASSERT_EQ(half.exitCode, 0) << half.err;
    EXPECT_NE(half.err.find("scans of the sensor 'right' are ignored; choose a sensor with "
                            "--sensor-label, or merge them with --sensor-label all"),
              std::string::npos)
        << half.err;
    for (const char* name : {"whole", "merged", "half"})
        RecordProperty(name, std::to_string(endError(name)));
    ASSERT_EQ(run(halves_, "again", {"--sensor-label", "all", "--threads", "2"}).exitCode, 0);
    for (const char* name : {"trajectory_kitti.txt", "posegraph.g2o", "trajectory_mrpt.txt"})
        EXPECT_TRUE(test::readText(fs::path(folder_ / "merged") / name) ==
                    test::readText(fs::path(folder_ / "again") / name))
            << name;
}

TEST_F(SeveralLidars, ASensorThatStopsIsSurvivedAndNamed) {
    test::splitDrive(
        rawlog_, halves_, [](std::size_t scan) { return scan < 20 || scan >= 40; },
        [](std::size_t scan) { return scan < 50; });
    const auto both = run(halves_, "both", {"--sensor-label", "left,right"});
    ASSERT_EQ(both.exitCode, 0) << both.err;
    EXPECT_NE(both.err.find("the sensor 'left' sent nothing from scan 20 to scan 39"),
              std::string::npos)
        << both.err;
    EXPECT_NE(both.err.find("the sensor 'right' sent nothing from scan 50 on"), std::string::npos)
        << both.err;
    EXPECT_LT(endError("both"), 0.5);
    EXPECT_EQ(run::RunFolder(folder_ / "both").summary().scans, 60U);
}

TEST_F(SeveralLidars, OneRawlogOfBoth) {
    test::splitDrive(rawlog_, halves_);
    const std::string one = folder_ / "one.rawlog";
    const auto made =
        test::runTool("scans2rawlog", {"-i", halves_, "-o", one, "--sensor-label", "all"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    ASSERT_EQ(run(halves_, "direct", {"--sensor-label", "all"}).exitCode, 0);
    ASSERT_EQ(run(one, "converted").exitCode, 0);
    EXPECT_TRUE(test::readText(folder_ / "direct/trajectory_kitti.txt") ==
                test::readText(folder_ / "converted/trajectory_kitti.txt"));
    test::expectFailure(run(halves_, "none", {"--sensor-label", "left,roof"}), 1,
                        {"no scans of the sensor 'roof'"});
}

/** Two VLP-16. The pose of the second one in `given.txt` is wrong by 5 cm and 1 deg. */
class SecondLidar : public SeveralLidars {
 protected:
    void SetUp() override {
        const auto made = test::runTool(
            "synth2rawlog", {"-o", rawlog_, "--scene", "urban", "--sensor", "vlp16", "--scans",
                             "90", "--seed", "4", "--start", "moving", "--distort", "--second",
                             "-0.8,0.3,0.1,170,3,0", "--epoch", "1700000000"});
        ASSERT_EQ(made.exitCode, 0) << made.err;
        test::writeText(given_,
                        "velodyne 0 0 0 0 0 0\nsecond -0.77 0.27 0.13 170.57735 3.57735 0.57735\n");
    }
    test::CommandResult calibrate(const std::string& name, const test::Words& more = {}) const {
        return run(rawlog_, name,
                   test::Words{"--sensor-label", "velodyne,second", "--extrinsics", given_,
                               "--calibrate-extrinsics"} +
                       more);
    }
    const std::string given_ = folder_ / "given.txt";
};

TEST_F(SecondLidar, ItsPoseIsRefinedFromTheDrive) {
    const auto done = calibrate("calibrated", {"--threads", "1"});
    ASSERT_EQ(done.exitCode, 0) << done.err;
    EXPECT_NE(done.out.find("sensor second"), std::string::npos) << done.out;
    std::map<std::string, double> found;
    for (const auto& [name, value] : run::RunFolder(folder_ / "calibrated").summary().extrinsics)
        found[name] = value;
    ASSERT_EQ(found.size(), 13U);
    EXPECT_NEAR(found["second x_m"], -0.8, 0.01);
    EXPECT_NEAR(found["second y_m"], 0.3, 0.01);
    EXPECT_NEAR(found["second z_m"], 0.1, 0.01);
    EXPECT_NEAR(found["second yaw_deg"], 170, 0.05);
    EXPECT_NEAR(found["second pitch_deg"], 3, 0.05);
    EXPECT_NEAR(found["second roll_deg"], 0, 0.05);
    for (const char* axis : {"x", "y", "z"}) {
        EXPECT_GT(found["second sigma_" + std::string(axis) + "_m"], 0);
        EXPECT_LT(found["second sigma_" + std::string(axis) + "_m"], 0.01);
    }
    // The precision is honest, but along the direction of travel, as the car brakes for long.
    EXPECT_NEAR(found["second y_m"], 0.3, 3 * found["second sigma_y_m"]);
    EXPECT_NEAR(found["second z_m"], 0.1, 3 * found["second sigma_z_m"]);
    EXPECT_NEAR(found["second yaw_deg"], 170, 3 * found["second sigma_about_z_deg"]);
    const auto again = calibrate("again", {"--threads", "2"});
    ASSERT_EQ(again.exitCode, 0) << again.err;
    const std::string poses = folder_ / "calibrated/extrinsics.txt";
    const auto given =
        run(rawlog_, "given", {"--sensor-label", "velodyne,second", "--extrinsics", poses});
    ASSERT_EQ(given.exitCode, 0) << given.err;
    for (const char* name : {"trajectory_kitti.txt", "extrinsics.txt"})
        EXPECT_TRUE(test::readText(fs::path(folder_ / "calibrated") / name) ==
                    test::readText(fs::path(folder_ / "again") / name))
            << name;
    EXPECT_FALSE(fs::exists(folder_ / "given/extrinsics.txt"));
    EXPECT_LT(endError("given"), 0.3);
}

TEST_F(SecondLidar, CalibrationNeedsTwoSensorsAndADrive) {
    test::expectFailure(run(rawlog_, "one", {"--calibrate-extrinsics"}), 1,
                        {"where several are merged"});
    test::expectFailure(test::runTool("delio-slam", {"-i", "udp://2368", "-o", folder_ / "live",
                                                     "--calibrate-extrinsics"}),
                        2, {"--calibrate-extrinsics needs one recording as input"});
    const auto shortDrive = calibrate("short", {"--count", "20"});
    ASSERT_EQ(shortDrive.exitCode, 0) << shortDrive.err;
    EXPECT_NE(shortDrive.err.find("the pose of the sensor 'second' was not refined: the drive has"),
              std::string::npos)
        << shortDrive.err;
    EXPECT_NE(test::readText(folder_ / "short/extrinsics.txt").find("second -0.77000 0.27000"),
              std::string::npos);
}
}  // namespace
