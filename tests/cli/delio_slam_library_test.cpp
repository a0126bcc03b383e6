// Whoever calls the library gets what delio-slam leaves.
#include <gtest/gtest.h>

#include "delio/picture/figures.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "same_files.h"

namespace {
using namespace delio;
using test::DelioSlam;

TEST_F(DelioSlam, TheLibraryLeavesTheSameFolder) {
    writeDrive();
    ASSERT_EQ(test::runTool("delio-slam", {"-i", rawlog_, "-o", out_}).exitCode, 0);

    const auto reader = io::openScans(rawlog_);
    auto scan = reader->next();
    ASSERT_TRUE(scan);
    run::RunSettings settings;
    settings.sensorLabel = reader->label();
    settings.drive = "d";  // after the rawlog
    run::Run run(Options::forDrive("accurate", reader->meta()), settings);
    run.readSideFiles(rawlog_);
    for (; scan; scan = reader->next()) run.process(*scan);
    run.finish(true);
    const std::string own = folder_ / "own";
    const run::RunFolder folder(own);
    EXPECT_EQ(folder.write(run.record(), run.maps(), picture::illustrate), "");

    EXPECT_EQ(test::namesIn(own), test::namesIn(out_));
    test::expectSameResults(own, out_);
    const auto a = folder.summary(), b = run::RunFolder(out_).summary();
    EXPECT_TRUE(a.complete);
    EXPECT_EQ(a.version, b.version);
    EXPECT_EQ(a.profile, b.profile);
    EXPECT_EQ(a.scans, b.scans);
    EXPECT_EQ(a.predicted, b.predicted);
    EXPECT_EQ(a.searched, b.searched);
    EXPECT_EQ(a.path_m, b.path_m);
    EXPECT_EQ(a.warnings, b.warnings);
    EXPECT_EQ(a.metrics, b.metrics);
    EXPECT_FALSE(a.metrics.empty());
}
}  // namespace
