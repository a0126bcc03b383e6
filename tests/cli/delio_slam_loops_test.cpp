#include <cmath>

#include "delio/core/numbers.h"
#include "delio_slam_fixture.h"

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
    const auto run = slam({"--loops"});
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
}

// Nothing to find: all is as without a search.
TEST_F(DelioSlamLoops, AStraightDriveHasNone) {
    writeDrive(4);
    ASSERT_EQ(slam({"--loops"}).exitCode, 0);
    EXPECT_EQ(readText(out_ / "loops.csv"), std::string(kColumns) + "\n");
    EXPECT_EQ(summary()["loops_closed"].as<int>(), 0);
    const std::string trajectory = readText(out_ / "trajectory_kitti.txt"),
                      graph = readText(out_ / "posegraph.g2o");
    ASSERT_EQ(slam({"--force"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(out_ / "loops.csv"));
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"), trajectory);
    EXPECT_EQ(readText(out_ / "posegraph.g2o"), graph);
}

TEST_F(DelioSlamLoops, NeedScans) {
    test::writeText(folder_ / "g.g2o", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n");
    expectRefused(slamOf(folder_ / "g.g2o", {"--loops"}), 1, {"--loops", "g.g2o"});
}

TEST_F(DelioSlamLoops, NeedTheGraph) {
    writeDrive(2);
    expectRefused(slam({"--loops", "--no-graph"}), 2, {"--loops", "--no-graph"});
}
}  // namespace
