// Whatever ends delio-slam: OUTDIR holds the old results, or all of the new ones, or a folder
// `incomplete` with the rows so far.
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

class Ended : public test::DelioSlam {
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
    /** Sends a signal after so many seconds, unless the run has ended. */
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

TEST_F(Ended, AtAnyMoment) {
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
        if (!fs::exists(out_ / "summary.yaml"))
            EXPECT_TRUE(fs::exists(out_ / "incomplete"));
        else if (readText(out_ / "summary.yaml") == readText(old / "summary.yaml"))
            expectAllOf(old);
        else if (summary()["complete"].as<bool>())
            test::expectSameResults(whole_, out_);
    }
    const auto again = slamInto({"--force"});
    ASSERT_EQ(again.exitCode, 0) << again.err;
    test::expectSameResults(whole_, out_);
    expectNothingLeft();
}

// The input pauses for more than a second, so that rows are flushed twice before the kill.
TEST_F(Ended, AKilledRunLeavesItsRows) {
    writeDrive(8, true);
    const fs::path killed = folder_ / "killed";
    const std::string in = "'" + rawlog_.string() + "'";
    const auto most = fs::file_size(rawlog_) * 3 / 4;
    const auto reading = [](const std::string& input, const fs::path& output) {
        return Words{"-c", "exec '" + test::toolPath("delio-slam") + "' --no-map -i - -o '" +
                               output.string() + "' < " + input};
    };
    ASSERT_EQ(runTool("bash", reading(in, out_)).exitCode, 0);
    const auto trajectory = run::RunFolder(out_.string()).odometry();
    const std::string slowly = "<(head -c " + std::to_string(most) + " " + in +
                               "; sleep 1.5; tail -c +" + std::to_string(most + 1) + " " + in +
                               "; sleep 20)";
    test::RunningTool run("bash", reading(slowly, killed));
    const run::RunFolder left((killed / run::RunFolder::kIncomplete).string());
    const auto hasRows = [&] {
        return left.has(run::RunFolder::kOdometry) &&
               test::linesOf(readText(left.path(run::RunFolder::kOdometry))).size() >= 3;
    };
    while (!run.hasEnded() && !hasRows()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    run.send(SIGKILL);
    ASSERT_EQ(run.wait().exitCode, 128 + SIGKILL);
    const auto poses = left.odometry().poses;
    ASSERT_GE(poses.size(), 3U);
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_EQ(poses[i].matrix(), trajectory.poses[i].matrix()) << i;
    const auto scans = left.scans();
    ASSERT_GE(scans.scans.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(scans.scans[i], i);
    // The next run replaces it.
    const Words again = {"-i", rawlog_, "-o", killed, "--no-map"};
    expectFailure(runTool("delio-slam", again), 1, {"exists", "--force"});
    ASSERT_EQ(runTool("delio-slam", again + Words{"--force"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(killed / run::RunFolder::kIncomplete));
}

TEST_F(Ended, ByCtrlC) {
    const auto stopped = runTool("delio-slam", {"-i", drive_, "-o", out_}, "scans 8");
    ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("interrupted; the results cover the first"), std::string::npos);
    EXPECT_FALSE(summary()["complete"].as<bool>());
    expectNothingLeft();
    expectFailure(slamInto({}), 1, {"exists", "--force"});
    expectFailure(slamInto({"--resume"}), 2, {"--resume"});
}

TEST_F(Ended, TwoRunsIntoOneFolder) {
    fs::create_directory(out_);
    const int folder = open(out_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(flock(folder, LOCK_EX | LOCK_NB), 0);
    expectFailure(slamInto({"--force"}), 1, {"another program"});
    close(folder);
    EXPECT_EQ(slamInto({"--count", "2", "--no-map"}).exitCode, 0);
}

TEST_F(Ended, OldResultsStayWhereNewOnesCannotBeWritten) {
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

TEST_F(Ended, WhatIsReadIsNotReplaced) {
    const auto before = test::namesIn(whole_);
    for (const char* input : {"posegraph.g2o", "map.ply"})
        expectFailure(runTool("delio-slam", {"-i", whole_ / input, "-o", whole_, "--force"}), 1,
                      {input, "choose another output"});
    expectFailure(runTool("delio-slam", {"-i", drive_, "-o", whole_, "--force", "--ground-truth",
                                         whole_ / "trajectory_kitti.txt"}),
                  1, {"trajectory_kitti.txt", "choose another output"});
    EXPECT_EQ(test::namesIn(whole_), before);
}
}  // namespace
