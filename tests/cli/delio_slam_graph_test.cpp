// delio-slam: a pose graph is optimised once more.
#include <gtest/gtest.h>

#include "delio/formats/trajectory.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using mrpt::containers::yaml;
using test::DelioSlam;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

/** What was done is said on stdout, as of drives. */
void expectGraphTable(const std::string& out) {
    for (const std::string line :
         {"nodes                      4\n", "edges ", "cost ", "iterations ", "path ", "results "})
        EXPECT_NE(out.find(line), std::string::npos) << line << out;
}

TEST_F(DelioSlam, OptimisesAGraphAgain) {
    writeDrive(4);
    ASSERT_EQ(slam().exitCode, 0);
    const fs::path graph = out_ / "posegraph.g2o";
    const std::string text = readText(graph);
    fs::copy_file(graph, folder_ / "g.g2o");
    fs::create_directories(folder_ / "again");
    const auto again = [&] {
        return runTool("delio-slam", {"-i", folder_ / "g.g2o", "-o", folder_ / "again", "--force"});
    };
    writeText(folder_ / "again" / "scans.csv", "of another run\n");
    const auto run = again();
    ASSERT_EQ(run.exitCode, 0) << run.err;
    expectGraphTable(run.out);
    const auto before = io::readTrajectory(out_ / "trajectory_kitti.txt").poses;
    const auto after = io::readTrajectory(folder_ / "again" / "trajectory_kitti.txt").poses;
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_LT((before[i].matrix() - after[i].matrix()).norm(), 1e-3);
    EXPECT_EQ(test::namesIn(folder_ / "again"),
              Words({"config.ini", "posegraph.g2o", "posegraph.graph", "summary.yaml",
                     "trajectory.png", "trajectory_kitti.txt", "trajectory_odometry_kitti.txt"}));
    const auto result = yaml::FromFile(folder_ / "again" / "summary.yaml");
    EXPECT_TRUE(result["complete"].as<bool>());
    EXPECT_EQ(result["scans"].as<int>(), 4);

    fs::remove_all(folder_ / "again");
    const auto broken = [&](const std::string& bytes, const Words& words) {
        writeText(folder_ / "g.g2o", bytes);
        test::expectFailure(again(), 1, words);
        EXPECT_FALSE(fs::exists(folder_ / "again"));
    };
    broken("", {"g.g2o", "VERTEX"});
    broken("words\n", {"line 1", "words"});
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string bytes = text;
        const auto at = bytes.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return bytes.replace(at, from.size(), to);
    };
    const std::string edge = text.substr(text.find("EDGE_SE3:QUAT 2 3"));
    const std::string line = edge.substr(0, edge.find('\n') + 1);
    const std::string head = "EDGE_SE3:QUAT 2 3 1 0 0 0 0 0 1 ";
    broken(changed(line, ""), {"no path of edges connects node 3"});
    broken(changed(line, head + "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 nan 0 0 1 0 1\n"), {"not finite"});
    broken(changed(line, head + "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 -1 0 0 1 0 1\n"),
           {"node 2 to node 3", "positive definite"});
    broken(text.substr(0, text.size() - 2), {"the file ends within this line"});
    broken(text.substr(0, text.size() / 2), {"g.g2o', line"});
    broken(text + "EDGE_SE3:QUAT 0 99 0 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n",
           {"99"});

    // Results of an earlier run stay.
    fs::create_directories(folder_ / "again");
    writeText(folder_ / "again" / "trajectory_kitti.txt", "precious\n");
    writeText(folder_ / "g.g2o", "words\n");
    test::expectFailure(again(), 1, {"words"});
    EXPECT_EQ(readText(folder_ / "again" / "trajectory_kitti.txt"), "precious\n");
    EXPECT_EQ(test::namesIn(folder_ / "again"), Words({"trajectory_kitti.txt"}));
}
}  // namespace
