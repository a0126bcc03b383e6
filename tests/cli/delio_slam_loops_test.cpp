#include <cmath>

#include "delio/core/text.h"
#include "delio/formats/trajectory.h"
#include "delio_slam_fixture.h"
#include "poses.h"

namespace {
using namespace delio;
using test::linesOf;
using test::readText;
namespace fs = std::filesystem;

class DelioSlamLoops : public test::DelioSlam {
 protected:
    /** A round of 94 m and a third of it again, a metre a scan. */
    void writeRoundDrive() const {
        constexpr double kRadius_m = 15;
        std::string poses;
        for (int i = 0; i < 125; ++i) {
            const double turn = i / kRadius_m, c = std::cos(turn), s = std::sin(turn);
            for (const double value :
                 {c, 0., s, kRadius_m * (1 - c), 0., 1., 0., 0., -s, 0., c, kRadius_m * s})
                poses += digitsOf(value) + " ";
            poses += "\n";
        }
        test::writeText(folder_ / "round.txt", poses);
        const auto made = test::runTool(
            "synth2rawlog", {"-o", rawlog_, "--scene", "urban", "--sensor", "vlp16", "--seed", "5",
                             "--scans", "125", "--trajectory", folder_ / "round.txt"});
        ASSERT_EQ(made.exitCode, 0) << made.err;
    }
    static constexpr const char* kColumns =
        "from_node,to_node,path_m,reach_m,image_share,plane_share,overlap,moved_m,x,y,z,yaw_deg,"
        "accepted,reason";
};

TEST_F(DelioSlamLoops, ARoundDriveIsClosed) {
    writeRoundDrive();
    const auto run = slam();
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto lines = linesOf(readText(out_ / "loops.csv"));
    ASSERT_GE(lines.size(), 2U);
    EXPECT_EQ(lines[0], kColumns);
    EXPECT_EQ(summary()["loop_candidates"].as<std::size_t>(), lines.size() - 1);
    EXPECT_GE(summary()["loops_closed"].as<int>(), 2);
    EXPECT_NE(run.out.find("closed of"), std::string::npos) << run.out;
    EXPECT_LT(summary()["metrics"]["ape_m"].as<double>(), 0.05);
    EXPECT_NE(readText(out_ / "trajectory_kitti.txt"),
              readText(out_ / "trajectory_odometry_kitti.txt"));
    EXPECT_NE(readText(out_ / "posegraph.graph").find("\n# loop "), std::string::npos);

    const auto eval = test::runTool(
        "delio-eval", {"--ref", folder_ / "d.poses.txt", "--est", "mine=" + out_.string()});
    ASSERT_EQ(eval.exitCode, 0) << eval.err;
    EXPECT_NE(eval.out.find("mine (odometry)"), std::string::npos) << eval.out;

    // Its graph given back stays as it is.
    const auto again = folder_ / "again";
    const auto second = test::runTool("delio-slam", {"-i", out_ / "posegraph.g2o", "-o", again});
    ASSERT_EQ(second.exitCode, 0) << second.err;
    const auto before = io::readTrajectory(out_ / "trajectory_kitti.txt").poses,
               after = io::readTrajectory(again / "trajectory_kitti.txt").poses;
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_LT(test::metresBetween(before[i], after[i]), 0.01) << i;

    // So is what one thread finds, in the drive.
    const fs::path one = folder_ / "one";
    ASSERT_EQ(test::runTool("delio-slam", {"-i", rawlog_, "-o", one, "--no-map", "--threads", "1"})
                  .exitCode,
              0);
    for (const char* name : {"loops.csv", "posegraph.g2o", "trajectory_kitti.txt"})
        EXPECT_TRUE(readText(out_ / name) == readText(one / name)) << name;
}

// Nothing to find: all is as without a search.
TEST_F(DelioSlamLoops, AStraightDriveHasNone) {
    writeDrive(4);
    ASSERT_EQ(slam().exitCode, 0);
    EXPECT_EQ(readText(out_ / "loops.csv"), std::string(kColumns) + "\n");
    EXPECT_EQ(summary()["loops_closed"].as<int>(), 0);
    const std::string trajectory = readText(out_ / "trajectory_kitti.txt"),
                      graph = readText(out_ / "posegraph.g2o");
    ASSERT_EQ(slam({"--force", "--no-loops"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(out_ / "loops.csv"));
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"), trajectory);
    EXPECT_EQ(readText(out_ / "posegraph.g2o"), graph);
}

TEST_F(DelioSlamLoops, AreLeftOutWithTheGraph) {
    writeDrive(2);
    ASSERT_EQ(slam({"--no-graph"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(out_ / "loops.csv"));
}
}  // namespace
