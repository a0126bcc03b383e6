#include <fstream>
#include <iomanip>

#include "delio/formats/trajectory.h"
#include "delio/map/cloud_files.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "poses.h"

// delio-map --import, and drives in what it makes.
namespace {
using namespace delio;
using test::DelioSlam;
using test::runTool;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

class ImportedMap : public DelioSlam {
 protected:
    /** The map of the toy drive, as another program has it. */
    void writeCloud(const Eigen::Isometry3d& cloudFromMap) const {
        writeDrive(12);
        const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        const auto points = map::loadPly(out_ / run::RunFolder::kPly);
        std::ofstream out(cloud_);
        out << "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
            << points.size() << "\nHEIGHT 1\nPOINTS " << points.size() << "\nDATA ascii\n"
            << std::setprecision(12);
        for (const auto& point : points)
            out << (cloudFromMap * point.position.cast<double>()).transpose() << "\n";
    }
    test::CommandResult import(const Words& more = {}) const {
        return runTool("delio-map", Words{"--import", cloud_, "-o", map_} + more);
    }
    void expectRefusal(const Words& words, int exitCode, const std::string& text) const {
        const auto refused = runTool("delio-map", words);
        EXPECT_EQ(refused.exitCode, exitCode) << refused.err;
        EXPECT_TRUE(test::isOneLine(refused.err)) << refused.err;
        EXPECT_NE(refused.err.find(text), std::string::npos) << refused.err;
        EXPECT_FALSE(fs::exists(map_));
    }

    const std::string cloud_ = folder_ / "cloud.pcd", map_ = folder_ / "cloud.delio";
};

TEST_F(ImportedMap, ADriveIsLocalisedInTheCloudsCoordinates) {
    const auto utm = test::poseAtDeg(456789.5, 5412345.25, 312, 40, 2, 1);
    writeCloud(utm);
    const auto made = import({"--spacing", "0.2"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(made.out, "");
    EXPECT_NE(made.err.find("less 457000, 5412000, 0 m"), std::string::npos) << made.err;
    const run::RunFolder own(out_), in(folder_ / "in");
    const auto run =
        runTool("delio-slam", {"-i", rawlog_, "-o", folder_ / "in", "--map", map_, "--no-map"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto wanted = own.trajectory().poses, there = in.trajectory().poses,
               inCloud = io::readTrajectory(in.path(run::RunFolder::kCloudTum)).poses;
    ASSERT_EQ(there.size(), wanted.size());
    ASSERT_EQ(inCloud.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_LT(test::metresBetween(inCloud[i], utm * wanted[i]), 0.1) << i;
        const Eigen::Vector3d offset = inCloud[i].translation() - there[i].translation();
        EXPECT_LT((offset - Eigen::Vector3d(457000, 5412000, 0)).norm(), 1e-6);
    }
    // And back to points: a .las has the cloud's coordinates.
    const auto back = runTool("delio-map", {"-i", map_, "-o", folder_ / "back.ply"});
    EXPECT_EQ(back.exitCode, 0) << back.err;
    EXPECT_TRUE(fs::exists(folder_ / "back.ply.frame.yaml"));
}

TEST_F(ImportedMap, RefusesWhatItCannotUse) {
    expectRefusal({"-o", map_}, 2, "-i, --clean or --import");
    expectRefusal({"--import", cloud_, "-i", cloud_, "-o", map_}, 2, "-i, --clean or --import");
    expectRefusal({"--import", cloud_, "-o", folder_ / "map.ply"}, 2, "-o OUT.delio");
    expectRefusal({"--import", cloud_, "-o", map_, "--frame", "ground"}, 2,
                  "--frame has no effect");
    expectRefusal({"--import", cloud_, "-o", map_, "--spacing", "0.01"}, 2, "0.05 to 2 m");
    expectRefusal({"--import", cloud_, "-o", map_}, 1, "cloud.pcd");
    test::writeText(cloud_,
                    "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n"
                    "POINTS 2\nDATA ascii\n1 2 3\n");
    expectRefusal({"--import", cloud_, "-o", map_}, 1, "1 of 2");
    expectRefusal({"--import", cloud_, "-o", folder_ / "none/map.delio"}, 1, "no such folder");
}

TEST_F(ImportedMap, RefusesACloudWithYUp) {
    writeCloud(test::poseAtDeg(0, 0, 0, 0, 0, -90));
    expectRefusal({"--import", cloud_, "-o", map_}, 1, "is flat along y");
}

TEST_F(ImportedMap, TheEdgesBetweenItsTilesStay) {
    writeCloud(Eigen::Isometry3d::Identity());
    ASSERT_EQ(import().exitCode, 0);
    test::writeText(folder_ / "edits.txt", "forbid 0 1\n");
    const auto run = runTool("delio-map", {"-i", map_, "--edits", folder_ / "edits.txt", "-o",
                                           folder_ / "edited.delio"});
    test::expectFailure(run, 1, {"'forbid 0 1'", "holds the drive or the imported cloud together"});
}

TEST_F(ImportedMap, OverwritesOnlyWhenAsked) {
    test::writeText(map_, "old");
    test::writeText(cloud_, "");
    const auto refused = import();
    EXPECT_EQ(refused.exitCode, 1);
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_EQ(test::readText(map_), "old");
}
}  // namespace
