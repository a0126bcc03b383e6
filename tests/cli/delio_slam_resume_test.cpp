// Whatever ends delio-slam: what was there before, or all that is new, or a folder `incomplete`
// that --resume goes on with, to the same bytes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include "delio/core/stopwatch.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "same_files.h"

namespace {
using namespace delio;
using test::expectFailure;
using test::readText;
using test::runTool;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

class Resume : public test::DelioSlam {
 protected:
    void SetUp() override {
        const auto made =
            runTool("synth2rawlog", {"-o", drive_, "--scene", "urban", "--sensor", "vlp16",
                                     "--scans", "40", "--movers", "8", "--distort", "--seed", "5"});
        ASSERT_EQ(made.exitCode, 0) << made.err;
        Stopwatch watch;
        ASSERT_EQ(runTool("delio-slam", {"-i", drive_, "-o", whole_}).exitCode, 0);
        duration_s_ = watch.lap_ms() / 1000;
    }

    test::CommandResult slamInto(const Words& more) const {
        return runTool("delio-slam", Words{"-i", drive_, "-o", out_} + more);
    }
    /** A signal after so many seconds, or an end of its own. */
    void ended(int signal, double after_s, const Words& more) const {
        test::RunningTool run("delio-slam", Words{"-i", drive_, "-o", out_} + more);
        std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
        run.send(signal);
        if (signal == SIGINT) run.send(signal);
        run.wait();
    }
    void expectAllOf(const fs::path& folder) const {
        for (const auto& file : fs::directory_iterator(folder))
            EXPECT_TRUE(readText(file.path()) == readText(out_ / file.path().filename()));
    }
    void expectNothingLeft() const {
        EXPECT_FALSE(fs::exists(out_ / "incomplete"));
        expectNothingPartial();
    }

    const fs::path drive_ = folder_ / "drive.rawlog", whole_ = folder_ / "whole";
    double duration_s_ = 0;
};

/** How often; more where DELIO_KILLS asks for it: see share/doc/reliability.md. */
int kills() {
    const char* const asked = std::getenv("DELIO_KILLS");
    return asked ? std::atoi(asked) : 8;
}

TEST_F(Resume, EndedAtAnyMoment) {
    const fs::path old = folder_ / "old";
    writeDrive();
    ASSERT_EQ(runTool("delio-slam", {"-i", rawlog_, "-o", old}).exitCode, 0);
    std::mt19937 random(20261123);
    std::uniform_real_distribution<double> moment(0, 1.1 * duration_s_);
    for (int i = 0; i < kills(); ++i) {
        SCOPED_TRACE(i);
        fs::remove_all(out_);
        fs::copy(old, out_);
        const int signal = i % 4 == 3 ? (i % 8 == 3 ? SIGTERM : SIGINT) : SIGKILL;
        ended(signal, moment(random), {"--force"});
        // Once more while it is being gone on with.
        if (i % 2 == 1 && fs::exists(out_ / "incomplete" / "state"))
            ended(SIGKILL, moment(random), {"--resume"});
        if (!fs::exists(out_ / "summary.yaml"))
            EXPECT_TRUE(fs::exists(out_ / "incomplete"));
        else if (readText(out_ / "summary.yaml") == readText(old / "summary.yaml"))
            expectAllOf(old);
        else if (summary()["complete"].as<bool>())
            test::expectSameResults(whole_, out_);
        else
            EXPECT_TRUE(fs::exists(out_ / "incomplete" / "state"));
        if (!fs::exists(out_ / "incomplete")) continue;
        const bool hasState = fs::exists(out_ / "incomplete" / "state");
        const auto again = slamInto({hasState ? "--resume" : "--force"});
        ASSERT_EQ(again.exitCode, 0) << again.err;
        test::expectSameResults(whole_, out_);
        expectNothingLeft();
    }
}

TEST_F(Resume, InterruptedAndGoneOnWith) {
    const Words words = {"-i", drive_, "-o", out_};
    const auto stopped = runTool("delio-slam", words, "scans 8");
    ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("--resume goes on"), std::string::npos) << stopped.err;
    EXPECT_FALSE(summary()["complete"].as<bool>());
    EXPECT_EQ(rows("incomplete/scans.csv"), rows("scans.csv"));
    EXPECT_EQ(rows("incomplete/trajectory_odometry_kitti.txt"), rows("trajectory_kitti.txt"));
    expectFailure(slamInto({}), 1, {"--resume", "--force"});
    expectFailure(slamInto({"--resume", "--set", "map.voxel_size=0.3"}), 1,
                  {"cannot be gone on with", "--force"});
    expectFailure(slamInto({"--resume", "--start", "1"}), 1, {"cannot be gone on with"});
    expectFailure(slamInto({"--resume", "--force"}), 2, {"--resume"});
    const auto again = slamInto({"--resume"});
    ASSERT_EQ(again.exitCode, 0) << again.err;
    EXPECT_NE(again.err.find("going on after"), std::string::npos) << again.err;
    test::expectSameResults(whole_, out_);
    EXPECT_TRUE(summary()["complete"].as<bool>());
    expectNothingLeft();
}

TEST_F(Resume, BeginsWhereThereIsNothingToGoOnWith) {
    ASSERT_EQ(slamInto({"--resume", "--count", "3", "--no-map"}).exitCode, 0);
    EXPECT_EQ(rows("trajectory_kitti.txt"), 3U);
    expectFailure(slamInto({"--resume"}), 1, {"exists", "--force"});
}

TEST_F(Resume, ADamagedStateIsRefused) {
    ASSERT_EQ(runTool("delio-slam", {"-i", drive_, "-o", out_}, "scans 8").exitCode, 130);
    const fs::path file = out_ / "incomplete" / "state";
    const std::string state = readText(file);
    for (const double part : {0.0, 0.001, 0.3, 0.9}) {
        test::writeText(
            file,
            state.substr(0, static_cast<std::size_t>(part * static_cast<double>(state.size()))));
        expectFailure(slamInto({"--resume"}), 1, {"cannot be gone on with", "--force"});
        std::string turned = state;
        turned[static_cast<std::size_t>(part * static_cast<double>(state.size()))] ^= 4;
        test::writeText(file, turned);
        expectFailure(slamInto({"--resume"}), 1, {"cannot be gone on with", "--force"});
    }
    test::writeText(file, state);
    fs::remove(out_ / "incomplete" / "map.spool");
    expectFailure(slamInto({"--resume"}), 1, {"map.spool"});
}

TEST_F(Resume, TwoRunsIntoOneFolder) {
    fs::create_directory(out_);
    const int folder = open(out_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(flock(folder, LOCK_EX | LOCK_NB), 0);
    for (const char* how : {"--force", "--resume"})
        expectFailure(slamInto({how}), 1, {"another program"});
    close(folder);
    EXPECT_EQ(slamInto({"--count", "2", "--no-map"}).exitCode, 0);
}

TEST_F(Resume, OldResultsStayWhereNewOnesCannotBeWritten) {
    writeDrive();
    ASSERT_EQ(runTool("delio-slam", {"-i", rawlog_, "-o", out_, "--no-map"}).exitCode, 0);
    const std::string summary = readText(out_ / "summary.yaml"),
                      trajectory = readText(out_ / "trajectory_kitti.txt");
    const auto run = test::runToolOnFullDisk(
        "delio-slam", {"-i", drive_, "-o", out_, "--no-map", "--force"}, 1024);
    expectFailure(run, 1, {"cannot write"});
    EXPECT_EQ(readText(out_ / "summary.yaml"), summary);
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"), trajectory);
}

TEST_F(Resume, WhatIsReadIsNotReplaced) {
    const auto before = test::namesIn(whole_);
    for (const char* input : {"posegraph.g2o", "map.ply"})
        expectFailure(runTool("delio-slam", {"-i", whole_ / input, "-o", whole_, "--force"}), 1,
                      {input, "choose another name"});
    expectFailure(runTool("delio-slam", {"-i", drive_, "-o", whole_, "--force", "--ground-truth",
                                         whole_ / "trajectory_kitti.txt"}),
                  1, {"trajectory_kitti.txt", "choose another name"});
    EXPECT_EQ(test::namesIn(whole_), before);
}
}  // namespace
