#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "command.h"
#include "delio/picture/scene.h"
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

/** Share of the pixels that have a colour, which what is drawn has, and neither the background nor
 *  grids and captions have. */
double colouredShare(const mrpt::img::CImage& picture) {
    std::size_t coloured = 0;
    for (unsigned y = 0; y < picture.getHeight(); ++y)
        for (unsigned x = 0; x < picture.getWidth(); ++x) {
            const auto* bgr = picture.ptr<std::uint8_t>(x, y);
            const auto [low, high] = std::minmax({bgr[0], bgr[1], bgr[2]});
            coloured += high - low > 40;
        }
    return static_cast<double>(coloured) /
           static_cast<double>(picture.getWidth() * picture.getHeight());
}

TEST(DelioFigures, MakesASceneAndAPictureOfEachStage) {
    const test::TemporaryFolder folder;
    const std::string rawlog = toyRawlog(folder, 4);
    const std::string out = folder / "figures";
    const auto made = test::runTool("delio-figures", {"-i", rawlog, "-o", out});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(made.out, "");
    // Dots on spheres, or lines all over: about half of what there is.
    const std::vector<std::pair<std::string, double>> figures = {{"normals_sphere", 0.001},
                                                                 {"outlier_removal", 0.002},
                                                                 {"line_cloud", 0.05},
                                                                 {"line_matches_before", 0.1},
                                                                 {"line_matches_after", 0.1}};
    for (const auto& [name, share] : figures) {
        EXPECT_TRUE(picture::loadScene(out + "/" + name + ".3Dscene"));
        mrpt::img::CImage picture;
        EXPECT_TRUE(picture.loadFromFile(out + "/" + name + ".png"));
        EXPECT_GT(picture.getWidth(), 900U);
        EXPECT_GT(colouredShare(picture), share) << name;
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
    expect({"-i", rawlog, "-o", rawlog}, 1, "is not a folder");
    EXPECT_FALSE(std::filesystem::exists(out + "/normals_sphere.png"));
}
}  // namespace
