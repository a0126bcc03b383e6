// map.html, and what was taken out of a map: delio-slam writes them, delio-map again.
#include <gtest/gtest.h>

#include "delio/map/cloud_files.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::DelioSlam;
namespace fs = std::filesystem;
using test::readText;
using test::runTool;
using test::Words;
using test::operator+;

bool isPage(const std::string& text) {
    return text.rfind("<!DOCTYPE html>", 0) == 0 && text.find("THREE") != text.npos;
}

/** With its map. */
test::CommandResult slamWithMap(const std::string& rawlog, const fs::path& out,
                                const Words& more = {}) {
    return runTool("delio-slam", Words{"-i", rawlog, "-o", out} + more);
}

TEST_F(DelioSlam, APageOfTheMapIsWrittenAndWrittenAgain) {
    writeDrive();
    const auto run = slamWithMap(rawlog_, out_, {"--keep-dynamic"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const run::RunFolder folder(out_);
    EXPECT_TRUE(folder.has(run::RunFolder::kDynamicPly));
    const std::string page = readText(out_ / "map.html");
    EXPECT_TRUE(isPage(page));
    for (const char* link : {"src=\"http", "href=\"http", "<link"})
        EXPECT_EQ(page.find(link), std::string::npos) << link;

    const std::string again = (folder_ / "again.html");
    const auto written = runTool("delio-map", {"-i", out_, "-o", again});
    ASSERT_EQ(written.exitCode, 0) << written.err;
    EXPECT_TRUE(isPage(readText(again)));
    const auto cropped =
        runTool("delio-map", {"-i", out_, "-o", again, "--crop", "-5,-5,-3,5,5,3", "--force"});
    ASSERT_EQ(cropped.exitCode, 0) << cropped.err;
    EXPECT_LT(readText(again).size(), page.size());
}

TEST_F(DelioSlam, WhatIsTakenOutIsKeptOnlyWhereItIsAskedFor) {
    writeDrive(3);
    ASSERT_EQ(slamWithMap(rawlog_, out_, {"--keep-dynamic"}).exitCode, 0);
    ASSERT_TRUE(fs::exists(out_ / "map_dynamic.ply"));
    ASSERT_EQ(slamWithMap(rawlog_, out_, {"--force"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(out_ / "map_dynamic.ply"));
    fs::remove_all(out_);
    expectRefused(slamWithMap(rawlog_, out_, {"--keep-dynamic", "--no-map"}), 2,
                  {"--keep-dynamic", "--no-map"});
}

TEST_F(DelioSlam, TheMapsPointsKnowWhatTheyAreColouredBy) {
    writeDrive();
    ASSERT_EQ(slamWithMap(rawlog_, out_).exitCode, 0);
    const auto points = map::loadPly(out_ / "map.ply");
    std::size_t withNormal = 0, seenTwice = 0, later = 0;
    for (const auto& point : points) {
        withNormal += point.normal.norm() > 0.99F;
        seenTwice += point.observations > 1;
        later += point.time_s > 0;
    }
    EXPECT_GT(withNormal, points.size() / 4);
    EXPECT_GT(seenTwice, points.size() / 10);
    EXPECT_GT(later, 0U);
    for (const char* by : {"normal", "time", "residual", "observations"}) {
        const auto run = runTool(
            "delio-map", {"-i", out_, "-o", folder_ / "by.ply", "--color-by", by, "--force"});
        EXPECT_EQ(run.exitCode, 0) << by << run.err;
    }
}
}  // namespace
