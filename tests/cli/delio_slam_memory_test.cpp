// Too little memory, wherever it runs out: one line, and what was done is written.
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::DelioSlam;
namespace fs = std::filesystem;

TEST_F(DelioSlam, TooLittleMemory) {
    writeDrive(10);
    std::size_t failed = 0;
    for (std::size_t megabytes = 40; megabytes <= 160; megabytes += 10) {
        SCOPED_TRACE(megabytes);
        fs::remove_all(out_);
        const auto run = test::runTool(
            "env", {"EGL_LOG_LEVEL=fatal", "prlimit", "--data=" + std::to_string(megabytes << 20),
                    test::toolPath("delio-slam"), "-i", rawlog_, "-o", out_, "--threads", "2"});
        ASSERT_TRUE(run.exitCode == 0 || run.exitCode == 1) << run.exitCode << run.err;
        if (run.exitCode == 0) continue;
        ++failed;
        EXPECT_TRUE(test::isOneLine(test::errorOf(run))) << run.err;
        if (fs::exists(out_ / "summary.yaml")) {
            EXPECT_EQ(rows("trajectory_kitti.txt"), summary()["scans"].as<std::size_t>());
        }
    }
    EXPECT_GT(failed, 0U);
}
}  // namespace
