#include <gtest/gtest.h>

#include <string>

#include "command.h"
#include "delio/run/summary.h"
#include "test_data.h"

// Sensors of few and of many beams, in scenes rich and poor in surfaces, from rest and at speed: a
// small part of the table that share/doc/accuracy.md has the figures of.
namespace {
using namespace delio;
using test::runTool;

struct Drive {
    const char *sensor, *scene;
    int seed;
    double most;  //!< end error, % of the path
};

std::string nameOf(const testing::TestParamInfo<Drive>& drive) {
    std::string name = std::string(drive.param.scene) + "_" + drive.param.sensor;
    for (auto& c : name)
        if (c == '-') c = '_';
    return name;
}

class Anywhere : public testing::TestWithParam<Drive> {};

INSTANTIATE_TEST_SUITE_P(
    Drives, Anywhere,
    testing::Values(Drive{"vlp16", "urban", 7, 1}, Drive{"vlp16", "highway", 7, 1},
                    Drive{"vlp16", "rural", 7, 1}, Drive{"hdl32e", "rural", 8, 1},
                    Drive{"hdl32e", "loop", 8, 1}, Drive{"os1-64", "highway", 9, 1},
                    Drive{"os1-64", "forest", 9, 1}, Drive{"hdl64e", "highway", 10, 1}),
    nameOf);

TEST_P(Anywhere, IsRegistered) {
    const test::TemporaryFolder folder;
    const auto rawlog = (folder / "d.rawlog").string(), out = (folder / "out").string();
    const auto& drive = GetParam();
    const auto made = runTool(
        "synth2rawlog", {"-o", rawlog, "--scans", "30", "--movers", "8", "--scene", drive.scene,
                         "--sensor", drive.sensor, "--seed", std::to_string(drive.seed)});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const auto slam = runTool("delio-slam", {"--no-map", "-i", rawlog, "-o", out});
    ASSERT_EQ(slam.exitCode, 0) << slam.err;
    const auto summary = run::readSummary(out + "/summary.yaml");
    EXPECT_EQ(summary.predicted, 0U);
    double end_percent = 100;
    for (const auto& [name, value] : summary.metrics)
        if (name == "end_error_percent") end_percent = value;
    EXPECT_LT(end_percent, drive.most);
}
}  // namespace
