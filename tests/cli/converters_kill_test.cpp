// Converters that are ended in the middle: an old drive, a new one or none, never parts of both.
#include <sys/stat.h>
#include <chrono>

#include <csignal>
#include <random>
#include <thread>

#include "drive_state.h"
#include "kitti_tools.h"

namespace {
using namespace delio;
using test::Words;
namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;

constexpr int kMoments = 14;
// Whose removal takes a while.
constexpr std::size_t kOldScans = 400;

class ConvertersKill : public test::KittiTools {
 protected:
    void SetUp() override {
        KittiTools::SetUp();
        test::writeSequence(folder_ / "long", test::fewScans(kOldScans));
    }

    /** Writes into out_; the drive that is there before it is in old_. */
    struct Case {
        std::string tool;
        Words words;
        std::string mark;  //!< without it there is no drive
    };

    /** Inodes and times of what is beside the mark. */
    std::string lookOf(const Case& what) const {
        std::string look;
        for (const auto& name : beside_) {
            struct stat status {};
            if (stat((out_ / what.mark).parent_path().append(name).c_str(), &status) == 0)
                look +=
                    std::to_string(status.st_ino) + " " + std::to_string(status.st_mtim.tv_nsec);
            look += "\n";
        }
        return look;
    }

    /** Every other time somewhere on the way, else just when the old drive is being replaced. */
    void waitForMoment(const Case& what, bool anywhere, test::RunningTool& running) {
        const double part = static_cast<double>(random_() % 1000) / 1000;
        if (anywhere) {
            std::this_thread::sleep_for(time_ * part * 1.2);
            return;
        }
        const std::string before = lookOf(what);
        while (lookOf(what) == before && !running.hasEnded()) std::this_thread::yield();
        if (part > 0.5) std::this_thread::sleep_for(Seconds(2e-4 * part));
    }

    /** Ends the tool at many moments. */
    void expectWhole(const Case& what) {
        const test::State before = test::stateOf(old_);
        test::restore(old_, out_);
        for (const auto& entry : fs::directory_iterator((out_ / what.mark).parent_path()))
            beside_.push_back(entry.path().filename());
        const auto begin = std::chrono::steady_clock::now();
        ASSERT_EQ(test::runTool(what.tool, what.words).exitCode, 0);
        time_ = std::chrono::steady_clock::now() - begin;
        const test::State after = test::stateOf(out_);
        ASSERT_NE(after, before);
        ASSERT_TRUE(after.count(what.mark));
        for (int i = 0; i < kMoments; ++i) {
            const int signal = i % 4 == 2 ? SIGTERM : i % 7 == 6 ? SIGINT : SIGKILL;
            test::restore(old_, out_);
            test::RunningTool running(what.tool, what.words);
            waitForMoment(what, i % 2 == 0, running);
            running.send(signal);
            running.wait();
            const test::State found = test::stateOf(out_);
            const std::string moment = what.tool + ", moment " + std::to_string(i);
            EXPECT_TRUE(found == before || found == after || found.count(what.mark) == 0)
                << moment << " signal " << signal << ": " << found.size() << " files";
            if (signal == SIGKILL) continue;
            EXPECT_TRUE(found == before || found == after) << moment;
            EXPECT_FALSE(test::hasLeftovers(out_)) << moment;
        }
    }

    std::mt19937 random_{1};
    Seconds time_{0};
    std::vector<std::string> beside_;
    fs::path old_ = folder_ / "old", out_ = folder_ / "out";
};

TEST_F(ConvertersKill, Kitti2rawlog) {
    fs::create_directory(old_);
    ASSERT_EQ(
        test::runTool("kitti2rawlog", {"-i", folder_ / "long", "-o", old_ / "d.rawlog"}).exitCode,
        0);
    expectWhole({"kitti2rawlog", {"-i", seq_, "-o", out_ / "d.rawlog", "--force"}, "d.rawlog"});
}

TEST_F(ConvertersKill, Synth2rawlog) {
    fs::create_directory(old_);
    ASSERT_EQ(
        test::runTool("kitti2rawlog", {"-i", folder_ / "long", "-o", old_ / "d.rawlog"}).exitCode,
        0);
    expectWhole({"synth2rawlog",
                 {"-o", out_ / "d.rawlog", "--force", "--scene", "urban", "--scans", "2",
                  "--sensor", "vlp16", "--threads", "1"},
                 "d.rawlog"});
}

TEST_F(ConvertersKill, Rawlog2kitti) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    fs::rename(out_, folder_ / "in");
    fs::create_directory(old_);
    fs::rename(folder_ / "long", old_ / "seq");
    expectWhole({"rawlog2kitti",
                 {"-i", folder_ / "in" / "d.rawlog", "-o", out_ / "seq", "--force"},
                 "seq/velodyne"});
}
}  // namespace
