// Scans that are missing in the middle of a drive.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "command.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using namespace delio;

/** 40 scans at speed, of which 12 are missing from the 20th on. */
std::string makeGap(const test::TemporaryFolder& folder) {
    std::string rawlog = folder / "gap.rawlog";
    const auto made = test::runTool(
        "synth2rawlog", {"-o", rawlog, "--scene", "urban", "--sensor", "vlp16", "--scans", "40",
                         "--seed", "7", "--start", "moving", "--gap", "20,12"});
    EXPECT_EQ(made.exitCode, 0) << made.err;
    return rawlog;
}

void expectFound(const std::string& input, const std::string& out) {
    const auto slam = test::runTool("delio-slam", {"-i", input, "-o", out, "--no-map", "--set",
                                                   "scan.vertical_correction_deg=0"});
    EXPECT_EQ(slam.exitCode, 0) << slam.err;
    const auto summary = run::RunFolder(out).summary();
    EXPECT_EQ(summary.scans, 28U);
    EXPECT_EQ(summary.predicted, 0U);
    EXPECT_EQ(summary.interrupted, 1U);
    const auto error = std::find_if(summary.metrics.begin(), summary.metrics.end(),
                                    [](const auto& it) { return it.first == "end_error_percent"; });
    ASSERT_NE(error, summary.metrics.end());
    EXPECT_LT(error->second, 0.2);
}

TEST(Gaps, TheMotionWentOn) {
    const test::TemporaryFolder folder;
    expectFound(makeGap(folder), folder / "out");
}

// The stamps count on as if no scan were missing.
TEST(Gaps, TheStampsMayHideThem) {
    const test::TemporaryFolder folder;
    const std::string sequence = folder / "sequence";
    ASSERT_EQ(test::runTool("rawlog2kitti", {"-i", makeGap(folder), "-o", sequence}).exitCode, 0);
    std::string times;
    for (int i = 0; i < 28; ++i) times += std::to_string(0.1 * i) + "\n";
    test::writeText(sequence + "/times.txt", times);
    expectFound(sequence, folder / "out");
}
}  // namespace
