// Ctrl-C and SIGTERM while a tool waits, and twice.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::operator+;
using test::DelioSlam;
using test::Words;
namespace fs = std::filesystem;

/** Both ends of a pipe that has a name, so that nobody waits for the other one. */
class Pipe {
 public:
    explicit Pipe(const fs::path& path) : path_(path) {
        mkfifo(path.c_str(), 0600);
        file_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    }
    ~Pipe() { close(file_); }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    const fs::path& path() const { return path_; }
    void write(const std::string& bytes) const {
        for (std::size_t done = 0; done < bytes.size();) {
            const auto count = ::write(file_, bytes.data() + done, bytes.size() - done);
            if (count > 0)
                done += static_cast<std::size_t>(count);
            else
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    /** As full as it gets: who writes more waits. */
    void fill() const {
        const std::array<char, 512> bytes{};
        while (::write(file_, bytes.data(), bytes.size()) > 0) continue;
        while (::write(file_, bytes.data(), 1) > 0) continue;
    }

 private:
    fs::path path_;
    int file_ = -1;
};

class Interrupts : public DelioSlam {
 protected:
    /** `redirection`: of the shell that becomes the tool. */
    static Words through(const std::string& redirection, const std::string& tool,
                         const Words& arguments) {
        return Words{"-c", "exec \"$0\" \"$@\" " + redirection, test::toolPath(tool)} + arguments;
    }
    /** Until the shell has become the tool, and that has begun. */
    static void waitUntilItCatches(test::RunningTool& run, const std::string& tool) {
        const fs::path process = "/proc/" + std::to_string(run.pid());
        while (!run.hasEnded()) {
            std::ifstream status(process / "status");
            std::string word, name, caught;
            while (status >> word)
                if (word == "Name:")
                    status >> name;
                else if (word == "SigCgt:")
                    status >> caught;
            constexpr unsigned long kTerm = 1UL << (SIGTERM - 1);
            if (name == tool && !caught.empty() && (std::stoul(caught, nullptr, 16) & kTerm) != 0)
                return;
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }
    static void waitFor(test::RunningTool& tool, const std::string& text) {
        const auto latest = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (tool.err().find(text) == std::string::npos && !tool.hasEnded()) {
            ASSERT_LT(std::chrono::steady_clock::now(), latest) << tool.err();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }

    Pipe pipe_{folder_ / "pipe"};
    const std::string fromPipe_ = "<'" + pipe_.path().string() + "'";
};

TEST_F(Interrupts, EndAWaitForTheFirstScan) {
    for (const int signal : {SIGINT, SIGTERM}) {
        for (const std::string tool : {"delio-slam", "scans2rawlog", "rawlog2kitti"}) {
            test::RunningTool run(
                "bash", through(fromPipe_, tool, {"-i", "-", "-o", folder_ / "new.rawlog"}));
            waitUntilItCatches(run, tool);
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            run.send(signal);
            EXPECT_EQ(run.wait().exitCode, 130) << tool;
            fs::remove(folder_ / "new.rawlog");  // an empty folder at most
            EXPECT_EQ(test::namesIn(folder_.path()), Words{"pipe"}) << tool;
        }
    }
}

TEST_F(Interrupts, EndAWaitForMoreAndWhatWasDoneIsWritten) {
    writeDrive(kScans, true);
    const std::string drive = test::readText(rawlog_);
    for (const std::string threads : {"1", "2"}) {
        const Pipe pipe(folder_ / ("pipe" + threads));
        test::RunningTool run("bash", through("<'" + pipe.path().string() + "'", "delio-slam",
                                              {"-i", "-", "-o", out_, "--no-map", "--verbose",
                                               "--force", "--threads", threads}));
        pipe.write(drive.substr(0, 9 * drive.size() / 10));
        waitFor(run, "scan 3:");  // the last that is whole: no later one is waited for
        run.send(SIGTERM);
        run.send(SIGTERM);  // as timeout(1) does
        const auto ended = run.wait();
        EXPECT_EQ(ended.exitCode, 130) << ended.err;
        EXPECT_EQ(ended.err.find("cut off"), std::string::npos) << ended.err;
        EXPECT_FALSE(summary()["complete"].as<bool>());
        EXPECT_EQ(summary()["scans"].as<std::size_t>(), 4U);
        EXPECT_EQ(rows("trajectory_kitti.txt"), 4U);
    }
}

TEST_F(Interrupts, EndAConversionThatWaitsAndLeaveNothing) {
    writeDrive(kScans, true);
    const std::string drive = test::readText(rawlog_);
    const auto before = test::namesIn(folder_.path());
    for (const std::string tool : {"scans2rawlog", "rawlog2kitti"}) {
        const fs::path made = folder_ / "new.rawlog";
        test::RunningTool run("bash", through(fromPipe_, tool, {"-i", "-", "-o", made}));
        pipe_.write(drive.substr(0, 9 * drive.size() / 10));
        waitUntilItCatches(run, tool);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        run.send(SIGINT);
        const auto ended = run.wait();
        EXPECT_EQ(ended.exitCode, 130) << tool << ended.err;
        EXPECT_EQ(test::namesIn(folder_.path()), before) << tool;
    }
}

// The table of results waits for a reader that does not come.
TEST_F(Interrupts, TheSecondOneEndsAtOnce) {
    writeDrive();
    pipe_.fill();
    test::RunningTool run("bash",
                          through(">'" + pipe_.path().string() + "'", "delio-slam",
                                  {"-i", rawlog_, "-o", out_, "--no-map", "--threads", "1"}));
    while (!fs::exists(out_ / "summary.yaml") && !run.hasEnded())
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    run.send(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    EXPECT_FALSE(run.hasEnded());
    run.send(SIGTERM);
    EXPECT_EQ(run.wait().exitCode, 130);
    EXPECT_TRUE(summary()["complete"].as<bool>());
}
}  // namespace
