// delio-slam of several drives: names, and results of all of them or none.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "delio/places/stored_map.h"
#include "delio_slam_fixture.h"
#include "drive_state.h"

namespace {
using namespace delio;
using test::operator+;
using test::DelioSlam;
using test::readText;
using test::runTool;
using test::Words;
namespace fs = std::filesystem;

class Several : public DelioSlam {
 protected:
    /** Two drives that do not meet. */
    void SetUp() override {
        for (const auto& [name, scene] : {std::pair{"a", "urban"}, {"b", "rural"}}) {
            const auto made =
                runTool("synth2rawlog", {"-o", folder_ / (name + std::string(".rawlog")), "--scene",
                                         scene, "--scans", "5", "--sensor", "vlp16", "--embed"});
            ASSERT_EQ(made.exitCode, 0) << made.err;
        }
    }
    Words joined(const Words& more = {}) const {
        return Words{"-i", folder_ / "a.rawlog", "-i", folder_ / "b.rawlog", "-o", out_} + more;
    }
    /** Of the results, what does not tell of times. */
    static test::State lastingOf(const fs::path& folder) {
        test::State lasting;
        for (const auto& [name, text] : test::stateOf(folder))
            for (const char* end : {".delio", "kitti.txt", "tum.txt", "drives.csv", ".g2o"})
                if (name.size() >= std::string(end).size() &&
                    name.compare(name.size() - std::string(end).size(), std::string::npos, end) ==
                        0)
                    lasting[name] = text;
        return lasting;
    }
};

TEST_F(Several, ADriveIsNotCalledAsAFileOfTheResultsIs) {
    const auto refused = [&](const std::string& name, const Words& words) {
        const fs::path recording = folder_ / name;
        fs::copy(folder_ / "a.rawlog", recording);
        expectRefused(runTool("delio-slam", joined({"-i", recording})), 1, words);
        fs::remove(recording);
    };
    refused("...rawlog", {"'..'", "rename the recording"});
    for (const std::string name : {"map.delio", "map-2.delio", "drives.csv", "summary.yaml",
                                   "a_kitti.txt", "b_tum.txt", "incomplete"})
        refused(name + ".rawlog", {"'" + name + "'", "rename the recording"});
    // One drive alone, too: its name is in the stored map.
    fs::copy(folder_ / "a.rawlog", folder_ / "...rawlog");
    expectRefused(slamOf(folder_ / "...rawlog"), 1, {"'..'"});
}

TEST_F(Several, AMapsDriveOfTheSameNameIsRefused) {
    ASSERT_EQ(runTool("delio-slam", {"-i", folder_ / "a.rawlog", "-o", folder_ / "old"}).exitCode,
              0);
    expectRefused(runTool("delio-slam", joined({"--map", folder_ / "old", "--extend"})), 1,
                  {"have the same name"});
}

TEST_F(Several, ComeInPlaceTogetherWheneverTheyAreKilled) {
    const fs::path old = folder_ / "old";
    ASSERT_EQ(runTool("delio-slam", joined({"--count", "3"})).exitCode, 0);
    const auto before = lastingOf(out_);
    ASSERT_EQ(before.count("drives.csv"), 1U);
    fs::rename(out_, old);
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(runTool("delio-slam", joined()).exitCode, 0);
    const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begin;
    const auto after = lastingOf(out_);
    ASSERT_NE(after, before);
    std::mt19937 random{2};
    for (int i = 0; i < 5; ++i) {
        test::restore(old, out_);
        test::RunningTool run("delio-slam", joined({"--force"}));
        std::this_thread::sleep_for(whole * (0.3 + 0.17 * i));
        run.send(SIGKILL);
        run.wait();
        const auto found = lastingOf(out_);
        EXPECT_TRUE(found == before || found == after || found.count("drives.csv") == 0) << i;
    }
    // An interrupt, and a failure of all drives, leave the old ones or write what was done.
    test::restore(old, out_);
    for (const char* name : {"a", "b"})
        test::writeText(folder_ / (name + std::string(".rawlog")), "no rawlog any more");
    EXPECT_EQ(runTool("delio-slam", joined({"--force"})).exitCode, 1);
    EXPECT_TRUE(lastingOf(out_) == before);
    EXPECT_FALSE(test::hasLeftovers(out_));
}

TEST_F(Several, WhatElseIsInTheFoldersStays) {
    fs::create_directories(out_ / "a");
    test::writeText(out_ / "a" / "mine.txt", "mine");
    test::writeText(out_ / "a" / "loops.csv", "old");
    test::writeText(out_ / "localisation.csv", "of a run of one drive");
    ASSERT_EQ(runTool("delio-slam", joined({"--force", "--no-loops"})).exitCode, 0);
    EXPECT_EQ(readText(out_ / "a" / "mine.txt"), "mine");
    EXPECT_FALSE(fs::exists(out_ / "a" / "loops.csv"));
    EXPECT_FALSE(fs::exists(out_ / "localisation.csv"));
    // And a run of one drive in their place.
    ASSERT_EQ(runTool("delio-slam", {"-i", folder_ / "a.rawlog", "-o", out_, "--force"}).exitCode,
              0);
    EXPECT_FALSE(fs::exists(out_ / "drives.csv"));
}

TEST_F(Several, NoPathOfThePartialFolderIsSaid) {
    const auto run = runTool("delio-slam", joined());
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ((run.out + run.err).find(".partial"), std::string::npos) << run.out << run.err;
    EXPECT_NE(run.out.find((out_ / "a").string()), std::string::npos) << run.out;
    EXPECT_EQ(readText(out_ / "b" / "summary.yaml").find(".partial"), std::string::npos);
    EXPECT_NE(readText(out_ / "b" / "summary.yaml").find((out_ / "map.delio").string()),
              std::string::npos);
}

TEST_F(Several, AFullDiskLeavesTheOldMap) {
    writeDrive(folder_ / "m.rawlog", test::toyScans(8), true);
    ASSERT_EQ(runTool("delio-slam", {"-i", folder_ / "m.rawlog", "-o", folder_ / "m"}).exitCode, 0);
    ASSERT_EQ(runTool("delio-slam", {"-i", folder_ / "a.rawlog", "-o", out_}).exitCode, 0);
    const std::string old = readText(out_ / "map.delio");
    const auto size = fs::file_size(folder_ / "m" / "map.delio");
    const auto run = test::runToolOnFullDisk(
        "delio-slam", joined({"--map", folder_ / "m", "--extend", "--force"}), size / 2048 * 1024);
    test::expectFailure(run, 1, {(out_ / "map.delio").string(), "the disk is full"});
    EXPECT_TRUE(readText(out_ / "map.delio") == old);
    EXPECT_FALSE(test::hasLeftovers(out_));
}
}  // namespace
