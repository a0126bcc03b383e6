#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <Eigen/Dense>
#include <iostream>
#include <string>

#include "command.h"
#include "delio/core/geometry.h"
#include "delio/formats/g2o.h"
#include "delio/formats/trajectory.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::runTool;

/** Means of e' C^-1 e over a graph's edges of so many scans; 3 is right for each. */
struct Normalised {
    double rotation = 0, translation = 0;
    int edges = 0;
};

Normalised normalisedErrors(const graph::PoseGraph& graph,
                            const std::vector<Eigen::Isometry3d>& truth, std::size_t span) {
    Normalised sum;
    for (const auto& edge : graph.edges()) {
        if (edge.to - edge.from != span) continue;
        // The true increment as the measured one's error: exp(w), t after it.
        const Eigen::Isometry3d error =
            edge.increment.pose.inverse() * (truth[edge.from].inverse() * truth[edge.to]);
        const Matrix6& covariance = edge.increment.covariance;
        const Eigen::Vector3d t = error.translation(), w = rotationLog(error.linear());
        sum.translation += t.dot(covariance.topLeftCorner<3, 3>().ldlt().solve(t));
        sum.rotation += w.dot(covariance.bottomRightCorner<3, 3>().ldlt().solve(w));
        ++sum.edges;
    }
    return {sum.rotation / sum.edges, sum.translation / sum.edges, sum.edges};
}

// share/doc/notes/pose_graph.md has longer drives; 40 scans leave their mark on a mean.
TEST(Covariance, HasTheSizeOfTheTrueErrors) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "d.rawlog";
    ASSERT_EQ(runTool("synth2rawlog", {"-o", rawlog, "--scene", "urban", "--scans", "40"}).exitCode,
              0);
    const auto Tr = io::readCalibration(folder / "d.calib.txt").Tr;
    std::vector<Eigen::Isometry3d> truth;
    for (const auto& pose : io::readTrajectory(folder / "d.poses.txt").poses)
        truth.push_back(Tr.inverse() * pose * Tr);
    for (const std::string profile : {"paper", "accurate"}) {
        const std::string out = folder / profile;
        std::vector<std::string> words = {"-i",       rawlog,      "-o",   out,
                                          "--no-map", "--profile", profile};
        if (profile == "paper")
            words.insert(words.end(), {"--set", "line_registration.search_radius=1"});
        const auto run = runTool("delio-slam", words);
        ASSERT_EQ(run.exitCode, 0) << run.err;
        const auto graph = io::loadG2o(out + "/posegraph.g2o");
        const bool isPaper = profile == "paper";
        for (const std::size_t span :
             isPaper ? std::vector<std::size_t>{1, 2, 5} : std::vector<std::size_t>{1}) {
            const auto found = normalisedErrors(graph, truth, span);
            std::cout << profile << ", " << span << " scans: rotation " << found.rotation
                      << ", translation " << found.translation << "\n";
            EXPECT_EQ(found.edges, 40 - static_cast<int>(span));
            EXPECT_GT(found.rotation, 0.8);
            EXPECT_LT(found.rotation, 9);
            EXPECT_GT(found.translation, 0.8);
            EXPECT_LT(found.translation, 9);
        }
        // Both trajectories are evaluated where the graph has more than the odometry's own edges.
        const auto summary = mrpt::containers::yaml::FromFile(out + "/summary.yaml");
        EXPECT_TRUE(summary.has("metrics"));
        EXPECT_EQ(summary.has("metrics_before_optimisation"), isPaper);
        EXPECT_EQ(run.out.find("unoptimised") != std::string::npos, isPaper) << run.out;
    }
}
}  // namespace
