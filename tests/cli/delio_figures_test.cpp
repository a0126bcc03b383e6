#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include "command.h"
#include "delio/map/scene.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;

std::string toyRawlog(const test::TemporaryFolder& folder, std::size_t scans) {
    test::writeSequence(folder / "toy", test::toyScans(scans));
    std::string rawlog = folder / "toy.rawlog";
    const auto converted = test::runTool("kitti2rawlog", {"-i", folder / "toy", "-o", rawlog});
    EXPECT_EQ(converted.exitCode, 0) << converted.err;
    return rawlog;
}

TEST(DelioFigures, MakesASceneAndAPictureOfEachStage) {
    const test::TemporaryFolder folder;
    const std::string rawlog = toyRawlog(folder, 4);
    const std::string out = folder / "figures";
    const auto made = test::runTool("delio-figures", {"-i", rawlog, "-o", out});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(made.out, "");
    for (const std::string name : {"normals_sphere", "outlier_removal", "line_cloud",
                                   "line_matches_before", "line_matches_after"}) {
        EXPECT_TRUE(map::loadScene(out + "/" + name + ".3Dscene"));
        mrpt::img::CImage picture;
        EXPECT_TRUE(picture.loadFromFile(out + "/" + name + ".png"));
        EXPECT_GT(picture.getWidth(), 900U);
    }
    // The profile that draws no lines of its own gives the same figures.
    EXPECT_EQ(test::runTool("delio-figures",
                            {"-i", rawlog, "-o", folder / "accurate", "--profile", "accurate"})
                  .exitCode,
              0);
    // They are not overwritten unless that is wanted.
    const auto again = test::runTool("delio-figures", {"-i", rawlog, "-o", out});
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_NE(again.err.find("--force"), std::string::npos);
    EXPECT_EQ(test::runTool("delio-figures", {"-i", rawlog, "-o", out, "--force"}).exitCode, 0);
}

TEST(DelioFigures, BadInput) {
    const test::TemporaryFolder folder;
    const std::string rawlog = toyRawlog(folder, 3);
    const std::string out = folder / "figures";
    const auto expect = [&](const std::vector<std::string>& options, int code,
                            const std::string& what) {
        const auto run = test::runTool("delio-figures", options);
        EXPECT_EQ(run.exitCode, code) << what;
        EXPECT_NE(run.err.find(what), std::string::npos) << run.err;
    };
    expect({"-i", folder / "none.rawlog", "-o", out}, 1, "none.rawlog");
    expect({"-i", rawlog, "-o", out, "--scan", "2"}, 1, "fewer than two scans from scan 2");
    expect({"-i", rawlog, "-o", out, "--set", "normals.k=3"}, 2, "normals.k");
    expect({"-i", rawlog, "-o", out, "--profile", "best"}, 2, "best");
    expect({"-i", rawlog, "-o", rawlog}, 1, "cannot make the folder");
    EXPECT_FALSE(std::filesystem::exists(out + "/normals_sphere.png"));
}
}  // namespace
