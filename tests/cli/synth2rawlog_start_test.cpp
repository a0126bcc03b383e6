#include <gtest/gtest.h>

#include <cstring>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "test_data.h"

// synth2rawlog's --start and --mount.
namespace {
using namespace delio;

test::CommandResult synth(const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"-o",       output,  "--scans", "3",
                                      "--sensor", "vlp16", "--seed",  "1"};
    words.insert(words.end(), more.begin(), more.end());
    return test::runTool("synth2rawlog", words);
}

/** The drive's first step, metres. */
double firstStep(const std::string& scene, const std::vector<std::string>& more) {
    const test::TemporaryFolder folder;
    std::vector<std::string> words = {"--scene", scene};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = synth(folder / "d.rawlog", words);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    return io::readTrajectory(folder / "d.poses.txt").poses.at(1).translation().norm();
}

TEST(Synth2RawlogStart, ADriveBeginsAsAsked) {
    for (const std::string scene : {"urban", "highway", "loop"}) {
        EXPECT_LT(firstStep(scene, {"--start", "rest"}), 0.1) << scene;
        EXPECT_GT(firstStep(scene, {"--start", "moving"}), 0.5) << scene;
    }
    EXPECT_GT(firstStep("highway", {}), 2);
}

std::vector<float> floatsOf(const std::filesystem::path& file) {
    const std::string bytes = test::readText(file);
    std::vector<float> floats(bytes.size() / sizeof(float));
    std::memcpy(floats.data(), bytes.data(), bytes.size());
    return floats;
}

TEST(Synth2RawlogMount, TurnsThePointsAndTheCalibrationAndNotCam0) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(synth(folder / "a.rawlog", {"--scene", "urban"}).exitCode, 0);
    const auto run = synth(folder / "b.rawlog", {"--scene", "urban", "--mount", "90,25,0"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(test::readText(folder / "a.poses.txt"), test::readText(folder / "b.poses.txt"));
    const auto upright = io::readCalibration(folder / "a.calib.txt");
    const auto turned = io::readCalibration(folder / "b.calib.txt");
    EXPECT_FALSE(upright.Tr.isApprox(turned.Tr, 0.1));
    const auto a = floatsOf(folder / "a_Images/000002.bin");
    const auto b = floatsOf(folder / "b_Images/000002.bin");
    ASSERT_EQ(a.size(), b.size());
    ASSERT_GT(a.size(), 40000U);
    for (std::size_t i = 0; i < a.size(); i += 400) {
        const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(&a[i]).cast<double>();
        const Eigen::Vector3d q = Eigen::Map<const Eigen::Vector3f>(&b[i]).cast<double>();
        EXPECT_LT((upright.Tr * p - turned.Tr * q).norm(), 1e-4);
        EXPECT_EQ(a[i + 3], b[i + 3]);
    }
}

TEST(Synth2RawlogStart, ABadCommandLineIsOneLineAndExit2) {
    const test::TemporaryFolder folder;
    const auto expectRefused = [&](const std::vector<std::string>& words, const std::string& part) {
        std::vector<std::string> all = {"--scene", "urban"};
        all.insert(all.end(), words.begin(), words.end());
        const auto run = synth(folder / "d.rawlog", all);
        test::expectFailure(run, 2, {part});
        EXPECT_FALSE(std::filesystem::exists(folder / "d.rawlog"));
    };
    for (const std::string start : {"standing", ""})
        expectRefused({"--start", start}, "choose one of: rest, moving");
    expectRefused({"--start", "rest", "--trajectory", "poses.txt"}, "--trajectory");
    expectRefused({"--start", "rest", "--motion", "handheld"}, "handheld");
    for (const std::string mount : {"0,25", "", "0,0,0,0", "0,nan,0", "0;25;0"})
        expectRefused({"--mount", mount}, "ROLL,PITCH,YAW");
}
}  // namespace
