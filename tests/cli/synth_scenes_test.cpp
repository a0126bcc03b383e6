#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "command.h"
#include "delio/io/trajectory.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;

test::CommandResult synth(const fs::path& output, std::vector<std::string> more) {
    std::vector<std::string> words = {"-o", output.string()};
    words.insert(words.end(), more.begin(), more.end());
    return runTool("synth2rawlog", words);
}

/** Poses of cam0 on a straight drive, 0.9 m a scan. */
std::string straightPoses(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(0.9 * i) + "\n";
    return text;
}

TEST(SynthScenes, EachHasAsManyPointsAsARealScan) {
    const test::TemporaryFolder folder;
    for (const std::string scene : {"urban", "rural", "highway", "loop", "tunnel"}) {
        const fs::path rawlog = folder / (scene + ".rawlog");
        const auto run = synth(rawlog, {"--scene", scene, "--scans", "2", "--seed", "3"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        const auto points = fs::file_size(folder / (scene + "_Images") / "000001.bin") / 16;
        EXPECT_GT(points, 95000U) << scene;
        EXPECT_LT(points, 130000U) << scene;
        EXPECT_EQ(io::readTrajectory(folder / (scene + ".poses.txt")).poses.size(), 2U);
    }
}

TEST(SynthScenes, ADriveAlongGivenPosesEndsWithThem) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "given.txt", straightPoses(4));
    const std::string given = folder / "given.txt";
    for (const std::string threads : {"1", "3"}) {
        const auto run = synth(
            folder / ("d" + threads + ".rawlog"),
            {"--scene", "rural", "--scans", "9", "--trajectory", given, "--threads", threads});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.err.find("ends after 4 of 9 scans"), std::string::npos) << run.err;
    }
    const auto poses = io::readTrajectory(folder / "d1.poses.txt").poses;
    ASSERT_EQ(poses.size(), 4U);
    EXPECT_NEAR(std::hypot(poses[3].translation().x(), poses[3].translation().z()), 2.7, 0.03);
    for (int i = 0; i < 4; ++i) {
        const std::string name = "00000" + std::to_string(i) + ".bin";
        EXPECT_EQ(test::readText(folder / "d1_Images" / name),
                  test::readText(folder / "d3_Images" / name));
    }
}

TEST(SynthScenes, ABadCommandLineIsOneLineAndExit2) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "given.txt", straightPoses(4));
    const std::string given = folder / "given.txt";
    const auto expectRefused = [&](const std::vector<std::string>& words, const std::string& part) {
        const auto run = synth(folder / "d.rawlog", words);
        EXPECT_EQ(run.exitCode, 2) << run.err;
        EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
        EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(folder / "d.rawlog"));
    };
    expectRefused({"--scene", "moon", "--scans", "3"}, "urban, rural, highway, loop, tunnel");
    expectRefused({"--scene", "", "--scans", "3"}, "urban");
    expectRefused({"--scene", "rural", "--scans", "0"}, "--scans");
    expectRefused({"--scene", "tunnel", "--scans", "3", "--trajectory", given}, "tunnel");
    expectRefused({"--scene", "loop", "--scans", "3", "--trajectory", given}, "loop");
    expectRefused({"--scene", "rural", "--scans", "3", "--trajectory", ""}, "--trajectory");
}

TEST(SynthScenes, ATrajectoryThatCannotBeDrivenIsOneLineAndExit1) {
    const test::TemporaryFolder folder;
    const auto expectRefused = [&](const std::string& text, const std::string& part) {
        test::writeText(folder / "bad.txt", text);
        const auto run = synth(folder / "d.rawlog", {"--scene", "urban", "--scans", "3",
                                                     "--trajectory", folder / "bad.txt"});
        EXPECT_EQ(run.exitCode, 1) << run.err;
        EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
        EXPECT_NE(run.err.find("bad.txt"), std::string::npos) << run.err;
        EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(folder / "d.rawlog"));
        EXPECT_FALSE(fs::exists(folder / "d_Images"));
    };
    expectRefused("", "empty");
    expectRefused(straightPoses(1), "one pose");
    expectRefused(straightPoses(2) + "1 0 0 0 0 1 0 0 0 0 1 101\n", "100 m from the pose before");
    expectRefused(straightPoses(2) + "1 0 0 0 0 1 0 0 0 0 1 nan\n", "line 3");
    expectRefused(straightPoses(2) + "1 0 0 0 0 3 0 0 0 0 1 1.8\n", "not a rotation");
    expectRefused(straightPoses(2) + "1 0 0 0 0 1 0 0 0 0 1\n", "line 3");
    const auto missing = synth(folder / "d.rawlog", {"--scene", "urban", "--scans", "3",
                                                     "--trajectory", folder / "none.txt"});
    EXPECT_EQ(missing.exitCode, 1);
    EXPECT_TRUE(test::isOneLine(missing.err)) << missing.err;
}
}  // namespace
