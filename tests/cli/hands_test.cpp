// A sensor in a swinging hand: it turns by up to 25 deg within a scan, and the scans show it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "command.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using namespace delio;

struct Hand {
    std::string scene, sensor;
    int seed;
};

class Hands : public testing::TestWithParam<Hand> {};
INSTANTIATE_TEST_SUITE_P(Swing, Hands,
                         testing::Values(Hand{"urban", "hdl64e", 301}, Hand{"forest", "vlp16", 302},
                                         Hand{"forest", "hdl32e", 303},
                                         Hand{"indoor", "os1-64", 304}),
                         [](const auto& of) {
                             std::string name = of.param.scene + "_" + of.param.sensor;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST_P(Hands, AreFollowedFromTheStart) {
    const auto& [scene, sensor, seed] = GetParam();
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "hand.rawlog", out = folder / "out";
    const auto made = test::runTool(
        "synth2rawlog", {"-o", rawlog, "--scene", scene, "--sensor", sensor, "--scans", "40",
                         "--seed", std::to_string(seed), "--motion", "handheld", "--distort"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const auto slam = test::runTool("delio-slam", {"-i", rawlog, "-o", out, "--no-map"});
    EXPECT_EQ(slam.exitCode, 0) << slam.err;
    const auto summary = run::RunFolder(out).summary();
    EXPECT_EQ(summary.predicted, 0U);
    const auto error = std::find_if(summary.metrics.begin(), summary.metrics.end(),
                                    [](const auto& it) { return it.first == "end_error_percent"; });
    ASSERT_NE(error, summary.metrics.end());
    EXPECT_LT(error->second, 1);
}
}  // namespace
