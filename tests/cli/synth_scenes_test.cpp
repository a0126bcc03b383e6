#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "command.h"
#include "delio/formats/trajectory.h"
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

/** Of the points of a scan: metres. */
std::vector<double> rangesOf(const fs::path& file) {
    const std::string bytes = test::readText(file);
    std::vector<float> xyzi(bytes.size() / sizeof(float));
    std::memcpy(xyzi.data(), bytes.data(), bytes.size());
    std::vector<double> ranges;
    for (std::size_t i = 0; i + 3 < xyzi.size(); i += 4)
        ranges.push_back(std::hypot(xyzi[i], xyzi[i + 1], xyzi[i + 2]));
    return ranges;
}

TEST(SynthScenes, EverySensorSeesHouseAndForestFromVehicleAndHand) {
    const test::TemporaryFolder folder;
    const std::map<std::string, std::size_t> beams = {
        {"hdl64e", 133312}, {"hdl32e", 69440}, {"vlp16", 28928}, {"os1-64", 65536}};
    for (const std::string scene : {"indoor", "forest"})
        for (const std::string motion : {"vehicle", "handheld"})
            for (const auto& [sensor, most] : beams) {
                const auto run = synth(folder / "d.rawlog",
                                       {"--scene", scene, "--motion", motion, "--scans", "1",
                                        "--sensor", sensor, "--movers", "4", "--force"});
                ASSERT_EQ(run.exitCode, 0) << run.err;
                const auto ranges = rangesOf(folder / "d_Images/000000.bin");
                const std::size_t least = scene == "indoor" ? most * 19 / 20 : most / 2;
                EXPECT_GT(ranges.size(), least) << scene << motion << sensor;
                EXPECT_LE(ranges.size(), most);
            }
}

TEST(SynthScenes, IndoorsASensorTellsWhatIsHalfAMetreAway) {
    const test::TemporaryFolder folder;
    for (const std::string scene : {"indoor", "forest"}) {
        ASSERT_EQ(synth(folder / "d.rawlog",
                        {"--scene", scene, "--scans", "60", "--sensor", "vlp16", "--force"})
                      .exitCode,
                  0);
        double nearest = 10;
        for (int scan = 10; scan < 60; ++scan) {
            const std::string name = "d_Images/0000" + std::to_string(scan) + ".bin";
            for (const double range : rangesOf(folder / name)) nearest = std::min(nearest, range);
        }
        EXPECT_GE(nearest, scene == "indoor" ? 0.4999 : 0.8999);
        if (scene == "indoor") {
            EXPECT_LT(nearest, 0.7);
        }
    }
}

TEST(SynthScenes, AHandheldDriveIsTheSameForAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    for (const std::string threads : {"1", "3"}) {
        const auto run =
            synth(folder / ("d" + threads + ".rawlog"),
                  {"--scene", "indoor", "--motion", "handheld", "--scans", "3", "--distort",
                   "--labels", "--movers", "3", "--sensor", "vlp16", "--threads", threads});
        ASSERT_EQ(run.exitCode, 0) << run.err;
    }
    EXPECT_EQ(test::readText(folder / "d1.poses.txt"), test::readText(folder / "d3.poses.txt"));
    for (const std::string ending : {".bin", ".time", ".label"})
        EXPECT_EQ(test::readText(folder / ("d1_Images/000002" + ending)),
                  test::readText(folder / ("d3_Images/000002" + ending)));
}

TEST(SynthScenes, AHandSwingsAlongGivenPosesToo) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "given.txt", straightPoses(9));
    const auto run = synth(folder / "d.rawlog",
                           {"--scene", "rural", "--scans", "9", "--motion", "handheld", "--sensor",
                            "vlp16", "--trajectory", (folder / "given.txt").string()});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    double turned = 0;
    const auto poses = io::readTrajectory(folder / "d.poses.txt").poses;
    for (const auto& pose : poses)
        turned = std::max(turned, Eigen::AngleAxisd(pose.linear()).angle());
    EXPECT_GT(turned, 0.2);
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
    expectRefused({"--scene", "moon", "--scans", "3"},
                  "urban, rural, highway, loop, tunnel, portal, indoor, forest");
    expectRefused({"--scene", "", "--scans", "3"}, "urban");
    expectRefused({"--scene", "rural", "--scans", "0"}, "--scans");
    expectRefused({"--scene", "tunnel", "--scans", "3", "--trajectory", given}, "tunnel");
    expectRefused({"--scene", "loop", "--scans", "3", "--trajectory", given}, "loop");
    expectRefused({"--scene", "rural", "--scans", "3", "--trajectory", ""}, "--trajectory");
    for (const std::string scene : {"indoor", "forest"})
        expectRefused({"--scene", scene, "--scans", "3", "--trajectory", given}, scene);
    for (const std::string motion : {"hand", ""})
        expectRefused({"--scene", "urban", "--scans", "3", "--motion", motion},
                      "choose one of: vehicle, handheld");
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
