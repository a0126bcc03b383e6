#include "delio/run/run_folder.h"

#include <sstream>

#include "comma_locale.h"
#include "delio/core/error.h"
#include "delio/run/summary.h"
#include "toy_run.h"

namespace {
using namespace delio;
using run::RunFolder;
using test::ToyRun;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/** All that is left without pictures. */
const Words kNames = {"config.ini",
                      "loops.csv",
                      "map.delio",
                      "map.html",
                      "map.ply",
                      "map.simplemap",
                      "posegraph.g2o",
                      "posegraph.graph",
                      "scans.csv",
                      "summary.yaml",
                      "trajectory_kitti.txt",
                      "trajectory_kitti_cam0.txt",
                      "trajectory_mrpt.txt",
                      "trajectory_odometry_kitti.txt",
                      "trajectory_tum.txt"};

void expectSamePoses(const std::vector<Eigen::Isometry3d>& found,
                     const std::vector<Eigen::Isometry3d>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_LT((found[i].matrix() - expected[i].matrix()).norm(), 1e-12) << i;
}

std::string textOf(const Options& options) {
    std::ostringstream text;
    options.write(text);
    return text.str();
}

TEST_F(ToyRun, FilesAreTheSameInAnyLocale) {
    writeSideFiles();
    run::Run run(Options(), {});
    run.readSideFiles(drive_);
    process(run);
    run.finish(true);
    const std::string other = folder_ / "other";
    EXPECT_EQ(RunFolder(out_).write(run.record(), run.maps()), "");
    const test::CommaLocale locale;
    EXPECT_EQ(RunFolder(other).write(run.record(), run.maps()), "");
    ASSERT_EQ(test::namesIn(other), kNames);
    for (const auto& name : kNames) {
        if (name == RunFolder::kSummary) continue;  // it has times of its own
        EXPECT_TRUE(test::readText(fs::path(other) / name) == test::readText(fs::path(out_) / name))
            << name;
    }
    const auto read = RunFolder(other).scans();
    ASSERT_EQ(read.stamps_s.size(), kScans);
    EXPECT_EQ(read.stamps_s[1], 0.2);
    EXPECT_EQ(textOf(RunFolder(other).options()), textOf(RunFolder(out_).options()));
    EXPECT_EQ(run::readSummary(fs::path(other) / RunFolder::kSummary).path_m,
              run.record().path_m());
}

TEST_F(ToyRun, EveryFileIsReadBack) {
    writeSideFiles();
    const Options options;
    run::Run run(options, {});
    run.readSideFiles(drive_);
    process(run);
    run.finish(true);
    const auto& record = run.record();
    const RunFolder folder(out_);
    EXPECT_EQ(folder.write(record, run.maps()), "");
    EXPECT_EQ(test::namesIn(out_), kNames);

    expectSamePoses(folder.trajectory().poses, record.final.poses);
    expectSamePoses(folder.odometry().poses, record.odometry.poses);
    expectSamePoses(folder.tum().poses, record.final.poses);
    EXPECT_EQ(folder.tum().stamps_s, record.final.stamps_s);
    const auto& Tr = record.calibration.Tr;
    std::vector<Eigen::Isometry3d> cam0;
    for (const auto& pose : record.final.poses) cam0.push_back(Tr * pose * Tr.inverse());
    expectSamePoses(folder.cam0().poses, cam0);

    const auto graph = folder.graph();
    expectSamePoses(graph.poses(), record.final.poses);
    ASSERT_EQ(graph.edges().size(), kScans - 1);
    for (std::size_t i = 0; i + 1 < kScans; ++i) {
        const auto& found = graph.information(i);
        const auto& written = record.graph.information(i);
        EXPECT_LT((found - written).norm(), 1e-9 * written.norm());
    }

    const auto table = folder.scans();
    EXPECT_EQ(table.scans, (std::vector<std::size_t>{10, 11, 12, 13}));
    EXPECT_EQ(table.predicted, std::vector<bool>(kScans, false));
    for (std::size_t i = 0; i < kScans; ++i)
        EXPECT_NEAR(table.stamps_s[i], record.rows[i].stamp_s, 1e-9);

    EXPECT_EQ(textOf(folder.options()), textOf(options));

    const auto map = folder.storedMap();
    EXPECT_EQ(map.graph().poses().size(), kScans);
    ASSERT_EQ(map.submaps().size(), 1U);
    EXPECT_GT(map.points(0).cols(), 1000);
    EXPECT_EQ(map.drives().at(0).stamps_s, record.odometry.stamps_s);

    const auto summary = folder.summary();
    EXPECT_TRUE(summary.complete);
    EXPECT_EQ(summary.fault, "");
    EXPECT_EQ(summary.scans, kScans);
    EXPECT_EQ(summary.predicted, 0U);
    EXPECT_EQ(summary.profile, "accurate");
    EXPECT_EQ(summary.command, "");
    EXPECT_NEAR(summary.path_m, kScans - 1, 0.1);
    EXPECT_EQ(summary.ms_per_scan_of_stages.front(), (std::pair<std::string, double>("read", 1.5)));
    EXPECT_EQ(summary.metrics.front().first, "length_m");
    EXPECT_NEAR(summary.metrics.front().second, kScans - 1, 1e-6);
}

TEST_F(ToyRun, TheFilesOfThePaperAreReadBackToo) {
    auto options = Options::ofProfile("paper");
    options.paper.lineRegistration.search_radius = 1;
    run::RunSettings settings;
    settings.profile = "paper";
    settings.map = false;
    run::Run run(options, settings);
    process(run);
    run.finish(true);
    EXPECT_EQ(run.maps().points, nullptr);
    EXPECT_EQ(run.maps().stored, nullptr);
    const RunFolder folder(out_);
    EXPECT_EQ(folder.write(run.record()), "");
    EXPECT_FALSE(folder.has(RunFolder::kPly));
    EXPECT_FALSE(folder.has(RunFolder::kCam0));  // no calibration
    EXPECT_EQ(textOf(folder.options()), textOf(options));
    EXPECT_GT(folder.graph().edges().size(), kScans - 1);
    expectSamePoses(folder.trajectory().poses, run.record().graph.poses());
    EXPECT_EQ(folder.summary().profile, "paper");
}

TEST_F(ToyRun, FilesOfAnEarlierRunDoNotStay) {
    writeSideFiles();
    run::Run first(Options(), {});
    first.readSideFiles(drive_);
    process(first);
    first.finish(true);
    const RunFolder folder(out_);
    folder.write(first.record(), first.maps());
    for (const char* name :
         {"map.3Dscene", "map.png", "map_removal.png", "trajectory.png", "mine.txt"})
        test::writeText(fs::path(out_) / name, "of an earlier run");

    // One without map, calibration and times.
    run::RunSettings settings;
    settings.map = false;
    run::Run second(Options(), settings);
    auto standing = scans();
    for (auto& scan : standing) {
        scan.stamp_s = 1;
        second.process(scan);
    }
    second.finish(false);
    folder.write(second.record());
    EXPECT_EQ(test::namesIn(out_),
              Words({"config.ini", "loops.csv", "mine.txt", "posegraph.g2o", "posegraph.graph",
                     "scans.csv", "summary.yaml", "trajectory_kitti.txt",
                     "trajectory_odometry_kitti.txt"}));
    EXPECT_FALSE(folder.summary().complete);

    // One without scans: a graph that is optimised again.
    const auto again = run::optimiseAgain(folder.graph(), Options(), {});
    folder.write(again);
    EXPECT_FALSE(folder.has(RunFolder::kScans));
    EXPECT_TRUE(folder.summary().complete);
    EXPECT_EQ(folder.summary().scans, kScans);
    expectSamePoses(folder.trajectory().poses, second.record().final.poses);
}

TEST_F(ToyRun, WhatCannotBeWrittenLeavesWhatWasThere) {
    run::Run run(Options(), {});
    process(run);
    run.finish(true);
    const RunFolder folder(out_);
    folder.write(run.record(), run.maps());
    fs::remove(folder.path(RunFolder::kGraph));
    fs::create_directory(folder.path(RunFolder::kGraph));
    const auto before = test::namesIn(out_);
    EXPECT_THROW(folder.write(run.record(), run.maps()), Error);
    EXPECT_TRUE(folder.summary().complete);
    EXPECT_EQ(folder.trajectory().poses.size(), kScans);
    EXPECT_EQ(test::namesIn(out_).size(), before.size());
}

TEST_F(ToyRun, WithoutItsPicturesAFolderIsWholeButForThem) {
    run::Run run(Options(), {});
    process(run);
    run.finish(true);
    const RunFolder folder(out_);
    const auto draw = [&](const run::RunRecord& record, const map::BuiltMap& map,
                          const RunFolder& into) {
        EXPECT_EQ(record.final.poses.size(), kScans);
        EXPECT_GT(map.points.size(), 1000U);
        EXPECT_FALSE(map.keyPoses.empty());
        EXPECT_TRUE(into.has(RunFolder::kPly));
        throw Error("no renderer");
    };
    EXPECT_EQ(folder.write(run.record(), run.maps(), draw), "no renderer");
    EXPECT_EQ(folder.summary().fault, "no renderer");
    EXPECT_TRUE(folder.summary().complete);
    // What ended the run is told before what is missing.
    run.fail("cut off");
    run.fail("later");
    EXPECT_EQ(folder.write(run.record(), run.maps(), draw), "cut off");
    EXPECT_EQ(folder.summary().fault, "cut off");
}

TEST_F(ToyRun, WhatIsMissingIsAnError) {
    const RunFolder none(folder_ / "none");
    EXPECT_FALSE(none.has(RunFolder::kTrajectory));
    EXPECT_THROW(none.trajectory(), Error);
    EXPECT_THROW(none.odometry(), Error);
    EXPECT_THROW(none.cam0(), Error);
    EXPECT_THROW(none.tum(), Error);
    EXPECT_THROW(none.graph(), Error);
    EXPECT_THROW(none.scans(), Error);
    EXPECT_THROW(none.options(), Error);
    EXPECT_THROW(none.summary(), Error);
}
}  // namespace
