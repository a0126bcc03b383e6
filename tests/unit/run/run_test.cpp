#include "delio/run/run.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <sstream>

#include "delio/core/error.h"
#include "delio/run/run_folder.h"
#include "poses.h"
#include "ring_scan.h"
#include "test_data.h"
#include "toy_run.h"

namespace {
using namespace delio;
using test::ToyRun;

/** A listener of somebody else's that fails on the third scan. */
template <typename Fault>
class Thrower : public SlamListener {
 public:
    const char* name() const override { return "thrower"; }
    void add(const SlamScan& scan) override {
        if (scan.node == 2) throw Fault();
    }
};
struct OutOfOrder : std::runtime_error {
    OutOfOrder() : std::runtime_error("out of order") {}
};

TEST_F(ToyRun, NotesEachScan) {
    run::Run run(Options(), {});
    for (const auto& scan : scans()) {
        const auto& row = run.process(scan, 1.5);
        EXPECT_EQ(row.scan, scan.index);
        EXPECT_EQ(row.stamp_s, scan.stamp_s);
        EXPECT_GT(row.points, 20000U);
        EXPECT_LE(row.points, scan.points->size());
        EXPECT_GT(row.total_ms(), 1.5);
        EXPECT_EQ(row.figures.listeners_ms().size(), 3U);  // graph, submaps and map
    }
    const auto& record = run.record();
    EXPECT_EQ(record.rows.size(), kScans);
    run.finish(true);
    EXPECT_TRUE(record.complete);
    EXPECT_TRUE(record.warnings.empty());
    EXPECT_EQ(record.predicted(), 0U);
    EXPECT_NEAR(record.path_m(), kScans - 1, 0.1);
    EXPECT_EQ(record.final.stamps_s, record.odometry.stamps_s);
    EXPECT_FALSE(record.optimised());
    EXPECT_FALSE(record.metrics);  // no truth
    EXPECT_GT(map::cloudOf(run.maps().points->build(record.final.poses).points).size(), 1000U);
}

TEST_F(ToyRun, AFullDiskDoesNotEndTheDrive) {
    const test::TemporaryFolder folder;
    run::RunSettings settings;
    settings.map = false;
    settings.folder = folder.path().string();
    const auto rows = folder / run::RunFolder::kIncomplete;
    {
        run::Run run(Options(), settings);
        std::filesystem::create_symlink("/dev/full", rows / run::RunFolder::kScans);
        process(run);
        run.finish(true);
        ASSERT_EQ(run.record().warnings.size(), 1U);
        EXPECT_NE(run.record().warnings[0].find(run::RunFolder::kScans), std::string::npos);
        EXPECT_EQ(run.record().fault, "");
        EXPECT_EQ(run.record().rows.size(), kScans);
        EXPECT_TRUE(std::filesystem::is_empty(rows));
    }
    EXPECT_FALSE(std::filesystem::exists(rows));
}

TEST_F(ToyRun, ContradictingOptionsAreRefused) {
    Options options;
    options.planes.scan.min_range = 50;
    options.planes.scan.max_range = 10;
    EXPECT_THROW(run::Run(options, {}), Error);
}

TEST_F(ToyRun, AGraphThatIsNotWantedIsTheChainAlone) {
    auto options = Options::ofProfile("paper");
    options.paper.lineRegistration.search_radius = 1;
    run::RunSettings settings;
    settings.map = settings.graph = false;
    run::Run run(options, settings);
    process(run);
    run.finish(true);
    EXPECT_EQ(run.record().graph.edges().size(), kScans - 1);
    for (std::size_t i = 0; i < kScans; ++i)
        EXPECT_EQ(run.record().final.poses[i].matrix(), run.record().odometry.poses[i].matrix());
}

TEST_F(ToyRun, ScoresBesideTheTruthOfTheScansThatWereUsed) {
    writeSideFiles();
    run::Run run(Options(), {});
    run.readSideFiles(drive_);
    process(run);
    run.finish(true);
    const auto& record = run.record();
    ASSERT_TRUE(record.metrics);
    EXPECT_NEAR(record.metrics->row.length_m, kScans - 1, 1e-6);
    EXPECT_LT(record.metrics->end_error_m, 0.1);
    EXPECT_FALSE(record.metricsBefore);  // there was nothing to optimise
    ASSERT_EQ(record.truth.size(), kScans);
    // In the vehicle's frame, for pictures.
    EXPECT_NEAR(record.truth.back().translation().x(), kScans - 1, 1e-6);
}

TEST_F(ToyRun, SideFilesThatCannotBeUsed) {
    writeSideFiles();
    std::vector<std::string> told;
    run::RunSettings settings;
    settings.map = false;
    settings.onWarning = [&](const std::string& text) { told.push_back(text); };
    {
        run::Run run(Options(), settings);
        EXPECT_THROW(run.readSideFiles(drive_, folder_ / "none.txt"), Error);
    }
    test::writeText(folder_ / "d.calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    run::Run run(Options(), settings);
    run.readSideFiles(drive_);
    EXPECT_EQ(told.size(), 2U);  // no Tr, and so no evaluation
    EXPECT_EQ(told, run.record().warnings);
    EXPECT_THROW(run.readSideFiles(drive_, folder_ / "d.poses.txt"), Error);  // asked for
    process(run);
    run.finish(true);
    EXPECT_FALSE(run.record().metrics);
    EXPECT_EQ(run.record().fault, "");
}

// Asked for, a truth that has not all scans is a fault; found beside the drive, a warning.
TEST_F(ToyRun, ATruthThatIsTooShort) {
    writeSideFiles();
    const std::string first = "1 0 0 0 0 1 0 0 0 0 1 0\n";
    test::writeText(folder_ / "d.poses.txt", first);
    run::RunSettings settings;
    settings.map = false;
    for (const bool asked : {false, true}) {
        run::Run run(Options(), settings);
        run.readSideFiles(drive_, asked ? std::string(folder_ / "d.poses.txt") : "");
        process(run);
        run.finish(true);
        EXPECT_EQ(run.record().fault.empty(), !asked);
        EXPECT_EQ(run.record().warnings.size(), asked ? 0U : 1U);
        EXPECT_FALSE(run.record().metrics);
        EXPECT_EQ(run.record().final.poses.size(), kScans);
    }
}

TEST_F(ToyRun, TimesThatDoNotRise) {
    run::RunSettings settings;
    settings.map = false;
    run::Run run(Options(), settings);
    auto drive = scans();
    drive[2].stamp_s = drive[1].stamp_s;
    for (const auto& scan : drive) run.process(scan);
    run.finish(true);
    EXPECT_FALSE(run.record().stampsRise);
    EXPECT_EQ(run.record().warnings.size(), 1U);
    EXPECT_TRUE(run.record().final.stamps_s.empty());
    EXPECT_EQ(run.record().odometry.stamps_s.size(), kScans);
}

TEST_F(ToyRun, AListenerThatThrowsIsNamedAndTheDriveGoesOn) {
    for (const auto& listener :
         std::vector<std::shared_ptr<SlamListener>>{std::make_shared<Thrower<OutOfOrder>>(),
                                                    std::make_shared<Thrower<std::bad_alloc>>()}) {
        run::Run run(Options(), {}), undisturbed(Options(), {});
        run.attach(listener);
        for (auto* each : {&run, &undisturbed}) process(*each);
        const std::string fault = run.record().fault;
        EXPECT_NE(fault.find("'thrower' failed at scan"), std::string::npos) << fault;
        EXPECT_TRUE(run.record().warnings.empty());
        run.finish(false);
        undisturbed.finish(true);
        EXPECT_EQ(run::RunFolder(out_).write(run.record(), run.maps(), {}), fault);
        const run::RunFolder results(out_);
        EXPECT_EQ(results.summary().fault, fault);
        EXPECT_EQ(results.scans().scans.size(), kScans);
        EXPECT_EQ(results.storedMap().submaps().size(), 1U);
        EXPECT_TRUE(results.has(run::RunFolder::kPly));
        const auto &poses = run.record().final.poses, &expected = undisturbed.record().final.poses;
        ASSERT_EQ(poses.size(), kScans);
        for (std::size_t i = 0; i < kScans; ++i) EXPECT_EQ(poses[i].matrix(), expected[i].matrix());
    }
}

// Whichever of the run's own parts fails, the odometry's results are there.
TEST_F(ToyRun, WithoutRoomForItsTemporaryFilesThereIsNoMap) {
    run::RunSettings settings;
    settings.folder = out_;
    run::Run run(Options(), settings);
    std::filesystem::remove(folder_ / "out" / run::RunFolder::kIncomplete);
    process(run);
    run.finish(false);
    const std::string fault = run::RunFolder(out_).write(run.record(), run.maps(), {});
    EXPECT_NE(fault.find("'map' failed at scan"), std::string::npos) << fault;
    EXPECT_NE(fault.find("cannot put scans for the map aside"), std::string::npos) << fault;
    const run::RunFolder results(out_);
    EXPECT_EQ(results.trajectory().poses.size(), kScans);
    EXPECT_FALSE(results.has(run::RunFolder::kPly));
}

// A room: the map is finer than in a street, and what config.ini says makes it again.
TEST_F(ToyRun, TheMapFollowsTheSizeOfThePlace) {
    std::vector<Scan> scans;
    test::Noise noise;
    for (int i = 0; i < 3; ++i) {
        const auto pose = test::poseAt(0.2 * i, 0, 0);
        scans.push_back(test::scanOf(
            test::ringScan(test::room(), pose, {32, 720, -24, 24, 0.01}, noise).points));
        scans.back().stamp_s = 0.1 * i;
        scans.back().time = mrpt::Clock::fromDouble(1e9 + 0.1 * i);
    }
    const auto driven = [&](const Options& options) {
        auto run = std::make_unique<run::Run>(options, run::RunSettings());
        for (const auto& scan : scans) run->process(scan);
        run->finish(true);
        return run;
    };
    const auto pointsOf = [](const run::Run& run) {
        return run.maps().points->build(run.record().final.poses).points;
    };
    const auto first = driven({});
    const auto details = first->record().rows.front().figures.details();
    const auto scale = std::find_if(details.begin(), details.end(),
                                    [](const auto& detail) { return detail.first == "scale"; });
    ASSERT_NE(scale, details.end());
    ASSERT_LT(scale->second, 1);
    const auto& used = first->record().options.map;
    EXPECT_EQ(used.voxelSize_m, scale->second * 0.2);
    EXPECT_EQ(used.minRange_m, scale->second * 2.5);
    std::ostringstream config;
    first->record().options.write(config);
    Options again, set;
    again.load(config.str());
    // (The floor, at -1.8 m, lies on the border of voxels of 0.2 m, and fills two layers.)
    set.load("[map]\nvoxel_size = 0.3\nmin_range = 2.5\n");
    const auto points = pointsOf(*first), same = pointsOf(*driven(again)),
               coarse = pointsOf(*driven(set));
    ASSERT_EQ(same.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_EQ(same[i].position, points[i].position) << i;
    EXPECT_GT(points.size(), coarse.size());
}
}  // namespace
