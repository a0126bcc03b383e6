// Starts: a sensor in a swinging hand, which turns by up to 25 deg within a scan, and rough ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

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

/** A drive of 40 scans that synth2rawlog makes with these arguments. */
void expectFollowed(const std::string& scene, const std::string& sensor, int seed,
                    const std::vector<std::string>& more) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "start.rawlog", out = folder / "out";
    std::vector<std::string> arguments{
        "-o",       rawlog,    "--scene", scene,    "--sensor",
        sensor,     "--scans", "40",      "--seed", std::to_string(seed),
        "--distort"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto made = test::runTool("synth2rawlog", arguments);
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

TEST_P(Hands, AreFollowedFromTheStart) {
    const auto& [scene, sensor, seed] = GetParam();
    expectFollowed(scene, sensor, seed, {"--motion", "handheld"});
}

// Rings on rough ground lie on those of the scan before at a wrong tilt, too. The scans that follow
// confirm it: without a new map the drive ended 9 % off.
TEST(StartsOnRoughGround, AreCorrectedAfterAWrongTilt) {
    expectFollowed("forest", "vlp16", 906, {"--movers", "4"});
}
}  // namespace
