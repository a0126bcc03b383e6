#include <cmath>

#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"

// --update of a stored map, and delio-map --at.
namespace {
using namespace delio;
using test::expectFailure;
using test::readText;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

constexpr double kFirst_s = 1.7e9, kDay_s = 86400;  // 2023-11-14T22:13:20Z

/** A street in which other cars are parked from the second day on. */
class Updates : public testing::Test {
 protected:
    static void SetUpTestSuite() { folder_ = new test::TemporaryFolder; }
    static void TearDownTestSuite() { delete folder_; }

    static std::string path(const std::string& name) { return *folder_ / name; }
    static std::string drive(int day) {
        std::string rawlog = path("drive" + std::to_string(day) + ".rawlog");
        if (fs::exists(rawlog)) return rawlog;
        const auto made =
            test::runTool("synth2rawlog",
                          {"-o", rawlog, "--scene", "urban", "--sensor", "vlp16", "--scans", "60",
                           "--seed", "501", "--start", "moving", "--drive-seed",
                           std::to_string(9000 + day), "--parked-seed", day == 0 ? "11" : "12",
                           "--epoch", std::to_string(static_cast<long>(kFirst_s + day * kDay_s))});
        EXPECT_EQ(made.exitCode, 0) << made.err;
        return rawlog;
    }
    static test::CommandResult slam(int day, const std::string& out, const Words& more = {}) {
        return test::runTool("delio-slam",
                             Words{"-i", drive(day), "-o", path(out), "--force"} + more);
    }
    /** The folder of the map after so many visits. */
    static std::string after(int visits) {
        const std::string name = "after" + std::to_string(visits);
        std::string out = path(name);
        if (fs::exists(out)) return out;
        Words more;
        if (visits > 1) more = {"--map", after(visits - 1), "--update"};
        const auto run = slam(visits - 1, name, more);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return out;
    }
    static Eigen::Matrix3Xf cloudOf(const std::string& folder) {
        return run::RunFolder(folder).storedMap().cloud(0.005);
    }
    /** Fraction of the points that are in the other cloud, to the rounding of the file. */
    static double fractionIn(const Eigen::Matrix3Xf& points, const Eigen::Matrix3Xf& other) {
        double found = 0;
        for (Eigen::Index i = 0; i < points.cols(); i += 5)
            found += (other.colwise() - points.col(i)).colwise().squaredNorm().minCoeff() < 1e-4;
        return found / std::ceil(static_cast<double>(points.cols()) / 5);
    }

    static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* Updates::folder_ = nullptr;

TEST_F(Updates, OtherParkedCarsAreInTheMapAfterTwoVisits) {
    const std::string before = readText(after(1) + "/map.delio");
    const auto first = cloudOf(after(1)), second = cloudOf(after(2)), third = cloudOf(after(3));
    EXPECT_TRUE(readText(after(1) + "/map.delio") == before);
    // One visit changes nothing.
    EXPECT_EQ(second.cols(), first.cols());
    EXPECT_EQ(fractionIn(first, second), 1);
    const double kept = fractionIn(first, third);
    EXPECT_GT(kept, 0.9);
    EXPECT_LT(kept, 0.995);
    EXPECT_LT(fractionIn(third, first), 0.995);

    // The same bytes by one thread.
    ASSERT_EQ(slam(2, "one", {"--map", after(2), "--update", "--threads", "1"}).exitCode, 0);
    EXPECT_TRUE(readText(path("one") + "/map.delio") == readText(after(3) + "/map.delio"));
}

TEST_F(Updates, TheMapOfADayIsWritten) {
    const auto at = [&](const std::string& time, const Words& more = {}) {
        return test::runTool(
            "delio-map",
            Words{"-i", after(3), "-o", path("at.ply"), "--force", "--at", time} + more);
    };
    const auto pointsAt = [&](const std::string& time) {
        const auto run = at(time, {"--verbose"});
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return run.err.substr(0, run.err.find('\n'));
    };
    const std::string firstDay = pointsAt("2023-11-15T08:00:00Z");
    EXPECT_EQ(firstDay, "delio-map: read " + std::to_string(cloudOf(after(1)).cols()) + " points");
    EXPECT_EQ(pointsAt("2023-12-01"),
              "delio-map: read " + std::to_string(cloudOf(after(3)).cols()) + " points");
    expectFailure(at("2023-11-14"), 1, {"begins at 2023-11-14T22:13:20Z"});
    expectFailure(at("soon"), 1, {"'soon' is not a time"});
    expectFailure(at(""), 2, {"--at needs a time"});
    expectFailure(test::runTool("delio-map",
                                {"-i", path("at.ply"), "-o", path("x.ply"), "--at", "2023-12-01"}),
                  2, {"--at needs a stored map"});
}

TEST_F(Updates, ADriveIsLocalisedInWhatIsThereNow) {
    ASSERT_EQ(slam(3, "in", {"--map", after(3), "--no-map"}).exitCode, 0);
    const auto where = run::RunFolder(path("in")).localisation();
    EXPECT_GT(std::count_if(where.begin(), where.end(),
                            [](const auto& row) { return row.where == Whereabouts::kInMap; }),
              50);
}

TEST_F(Updates, WhatCannotBeUpdatedIsSaid) {
    const Words update{"--map", after(2), "--update"};
    expectFailure(slam(1, "no", {"--update"}), 2, {"--update needs --map"});
    expectFailure(slam(2, "no", update + Words{"--no-map"}), 2, {"--no-map"});
    expectFailure(slam(2, "no", update + Words{"--extend"}), 2, {"without --extend"});
    expectFailure(slam(2, "no", update + Words{"--set", "removal.enabled=false"}), 1,
                  {"removal.enabled"});
    expectFailure(slam(1, "again", update), 1, {"the map was not updated", "not after"});
    EXPECT_TRUE(fs::exists(path("again") + "/trajectory_kitti.txt"));
    EXPECT_FALSE(fs::exists(path("again") + "/map.delio"));
    expectFailure(slam(2, "after2", update), 1, {"overwrite the map"});

    const auto full = test::runToolOnFullDisk(
        "delio-slam", Words{"-i", drive(2), "-o", path("full")} + update, 100 * 1024);
    EXPECT_EQ(full.exitCode, 1) << full.err;
    EXPECT_NE(full.err.find("'map' failed"), std::string::npos) << full.err;

    // A drive and a map without times.
    const std::string timeless = path("timeless.rawlog");
    ASSERT_EQ(
        test::runTool("synth2rawlog", {"-o", timeless, "--scene", "urban", "--sensor", "vlp16",
                                       "--scans", "30", "--seed", "501", "--start", "moving"})
            .exitCode,
        0);
    expectFailure(test::runTool("delio-slam", Words{"-i", timeless, "-o", path("no")} + update), 1,
                  {"no Unix times"});
    ASSERT_EQ(test::runTool("delio-slam", {"-i", timeless, "-o", path("old")}).exitCode, 0);
    expectFailure(
        test::runTool("delio-map", {"-i", path("old"), "-o", path("x.ply"), "--at", "2023-12-01"}),
        1, {"have no times"});
}
}  // namespace
