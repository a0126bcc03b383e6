// There and back: rawlog2kitti on what kitti2rawlog wrote, and bad inputs.
#include <limits>

#include "delio/formats/trajectory.h"
#include "kitti_tools.h"

namespace {
using namespace delio;
using test::fewPoints;
using test::fewScans;
using test::KittiTools;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

TEST_F(KittiTools, ThereAndBackIsBitExact) {
    auto odd = fewPoints(9, 4);
    odd[1] = std::numeric_limits<float>::quiet_NaN();
    odd[6] = std::numeric_limits<float>::infinity();
    odd[8] = -0.0F;
    odd[15] = std::numeric_limits<float>::quiet_NaN();
    test::writeFloats(seq_ / "velodyne" / "000002.bin", odd);
    writeText(seq_ / "velodyne" / "000003.bin", "");
    for (const Words& storage : {Words(), Words{"--embed"}}) {
        Words words = storage;
        words.emplace_back("--force");
        const auto there = toRawlog(words);
        ASSERT_EQ(there.exitCode, 0) << there.err;
        EXPECT_EQ(there.out, "");
        EXPECT_EQ(fs::exists(side("_Images")), storage.empty());
        const auto back = toKitti(folder_ / "back", {"--force"});
        ASSERT_EQ(back.exitCode, 0) << back.err;
        EXPECT_EQ(test::namesIn(folder_ / "back"), test::namesIn(seq_));
        for (const auto& name : test::namesIn(seq_))
            if (fs::is_regular_file(seq_ / name)) {
                EXPECT_EQ(test::readText(seq_ / name), test::readText(folder_ / "back" / name))
                    << name;
            }
    }
}

TEST_F(KittiTools, TimesComeBackWithoutTheirFile) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    fs::remove(side(".times.txt"));
    ASSERT_EQ(toKitti(folder_ / "back").exitCode, 0);
    const auto back = io::readTimes(folder_ / "back" / "times.txt");
    ASSERT_EQ(back.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(back[i], 0.1 * static_cast<double>(i), 1e-7);
}

TEST_F(KittiTools, SideFilesThatDoNotBelongToTheScansAreRefused) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    const fs::path target = folder_ / "back";
    const auto expectRefusal = [&](const std::string& name, const std::string& text,
                                   const std::string& word) {
        const std::string good = test::readText(side("." + name));
        writeText(side("." + name), text);
        test::expectFailure(toKitti(target), 1, {side("." + name), word});
        EXPECT_FALSE(fs::exists(target)) << name << text;
        writeText(side("." + name), good);
    };
    const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
    expectRefusal("times.txt", "0\n0.1\nnoon\n0.3\n0.4\n", "line 3");
    expectRefusal("times.txt", "0\nnan\n0.2\n0.3\n0.4\n", "line 2");
    expectRefusal("times.txt", "0\n0.1\n0.2\n0.3\n", "4 rows for 5 scans");
    expectRefusal("times.txt", "0\n1\n2\n3\n4\n5\n", "6 rows for 5 scans");
    expectRefusal("times.txt", "", "empty");
    expectRefusal("poses.txt", pose + pose, "2 rows for 5 scans");
    expectRefusal("poses.txt", "somewhere\n", "line 1");
    expectRefusal("calib.txt", "Tr: 1 2 3\n", "line 1");
    EXPECT_EQ(toKitti(target).exitCode, 0);
}

TEST_F(KittiTools, Rawlog2kittiRefusesAndLeavesNothing) {
    ASSERT_EQ(toRawlog({"--embed"}).exitCode, 0);
    const fs::path target = folder_ / "back";
    const auto expectNothing = [&](const test::CommandResult& run, const Words& words) {
        test::expectFailure(run, 1, words);
        EXPECT_EQ(run.out, "");
        EXPECT_FALSE(fs::exists(target));
        EXPECT_FALSE(fs::exists(folder_ / ".partial-back"));
    };
    expectNothing(runTool("rawlog2kitti", {"-i", folder_ / "none.rawlog", "-o", target}),
                  {"none.rawlog"});
    expectNothing(runTool("rawlog2kitti", {"-i", seq_ / "times.txt", "-o", target}),
                  {"times.txt", "not a rawlog"});
    expectNothing(toKitti(target, {"--sensor-label", "ouster"}), {"no LiDAR scans"});
    test::expectFailure(toKitti("/proc/back"), 1, {"/proc/back"});
    test::expectFailure(toKitti(seq_ / "times.txt" / "back"), 1, {"times.txt/back"});
    const std::string bytes = test::readText(rawlog_);
    writeText(rawlog_, bytes.substr(0, bytes.size() * 2 / 3));
    expectNothing(toKitti(target), {"cut off"});
    writeText(rawlog_, "");
    expectNothing(toKitti(target), {"empty"});
    writeText(side(".meta.yaml"), "epoch_unix_s: noon\n");
    expectNothing(toKitti(target), {"meta.yaml"});
}

TEST_F(KittiTools, Rawlog2kittiReplacesNothingButTheSequence) {
    ASSERT_EQ(toRawlog({"--count", "2"}).exitCode, 0);
    const fs::path target = folder_ / "back";
    test::writeSequence(target, fewScans(4));
    writeText(target / "mine.txt", "mine");
    test::expectFailure(toKitti(target), 1, {target, "--force"});
    fs::remove(side(".calib.txt"));
    ASSERT_EQ(toKitti(target, {"--force"}).exitCode, 0);
    EXPECT_EQ(test::namesIn(target), Words({"mine.txt", "poses.txt", "times.txt", "velodyne",
                                            "velodyne/000000.bin", "velodyne/000001.bin"}));
    EXPECT_EQ(test::readText(target / "mine.txt"), "mine");
    writeText(folder_ / "file", "mine");
    test::expectFailure(toKitti(folder_ / "file", {"--force"}), 1, {"not a folder"});
    EXPECT_EQ(test::readText(folder_ / "file"), "mine");
}
}  // namespace
