#include "delio/graph/pose_graph.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>

#include <cmath>
#include <limits>

#include "gauss_newton.h"
#include "pose_graph_drive.h"

namespace {
using namespace delio;
using namespace delio::pose_graph_test;

// MRPT's own optimiser stays at 0.5 here: without its information matrix, that is the minimum.
TEST(PoseGraph, EdgesInConflictMeetWhereTheirInformationSays) {
    for (const double start : {0.5, -30.0, 1.0}) {
        PoseGraph graph;
        graph.addNode(Eigen::Isometry3d::Identity());
        graph.addNode(poseAt(start, 0, 0, 0.3, 0.2, 0.1));
        graph.addEdge(0, 1, Eigen::Isometry3d::Identity(), 100 * Matrix6::Identity());
        graph.addEdge(0, 1, poseAt(1, 0, 0, 0, 0, 0), Matrix6::Identity());
        const auto result = graph.optimise(withKernel(0));
        EXPECT_NEAR(graph.poses()[1].translation().x(), 1.0 / 101, 1e-9);
        EXPECT_NEAR(result.final_cost, 100.0 / 101, 1e-9);
        EXPECT_TRUE(result.converged);
    }
}

// Two edges that differ in one axis only. Each is sure of that axis or of another; where the two
// were mixed up (MRPT stores yaw where delio has wx), the unsure edge would win.
TEST(PoseGraph, CovariancesAreInTheOrderXyzWxWyWz) {
    const double disagreement = 0.1;
    for (std::size_t axis = 0; axis < 6; ++axis) {
        for (std::size_t other = 0; other < 6; ++other) {
            if (other == axis) continue;
            std::vector<double> sure(6, 1), unsure(6, 1);
            sure[axis] = 1e-4;
            unsure[other] = 1e-4;
            test::Vector6d e = test::Vector6d::Zero();
            e[static_cast<int>(axis)] = disagreement;
            const Eigen::Isometry3d differing = poseAt(e[0], e[1], e[2], e[5], e[4], e[3]);
            PoseGraph graph;
            graph.addNode(Eigen::Isometry3d::Identity());
            graph.addNode(Eigen::Isometry3d::Identity());
            graph.addEdge(edgeOf(0, 1, Eigen::Isometry3d::Identity(), sure));
            graph.addEdge(edgeOf(0, 1, differing, unsure));
            graph.optimise(withKernel(0));
            const Eigen::Isometry3d& end = graph.poses()[1];
            test::Vector6d change;
            change << end.translation(), rotationLog(end.linear());
            EXPECT_NEAR(change[static_cast<int>(axis)], disagreement * 1e-4 / (1 + 1e-4), 1e-9)
                << axis << " " << other;
        }
    }
}

// The later frame is turned left by 90 degrees: its x is the earlier frame's y.
TEST(PoseGraph, CovariancesAreInTheLaterFrame) {
    PoseGraph graph;
    graph.addNode(Eigen::Isometry3d::Identity());
    graph.addNode(Eigen::Isometry3d::Identity());
    graph.addEdge(edgeOf(0, 1, poseAt(0, 0, 0, M_PI / 2, 0, 0), {1e-4, 1, 1, 1, 1, 1}));
    graph.addEdge(edgeOf(0, 1, poseAt(0.2, 0.2, 0, M_PI / 2, 0, 0), {1, 1e-4, 1, 1, 1, 1}));
    graph.optimise(withKernel(0));
    EXPECT_NEAR(graph.poses()[1].translation().y(), 0.2 * 1e-4 / (1 + 1e-4), 1e-9);
    EXPECT_NEAR(graph.poses()[1].translation().x(), 0.2 / (1 + 1e-4), 1e-9);
}

TEST(PoseGraph, AgreesWithBruteForceAndNode0Stays) {
    PoseNoise noise;
    PoseGraph graph;
    Poses truth;
    for (int i = 0; i < 12; ++i) {
        truth.push_back(noise.pose(5, 3));
        graph.addNode(truth.back() * noise.pose(0.3, 0.2));
    }
    const auto connect = [&](std::size_t i, std::size_t j) {
        graph.addEdge(i, j, truth[i].inverse() * truth[j] * noise.pose(0.1, 0.1),
                      noise.information());
    };
    // Backwards, twice over, and all round.
    for (std::size_t i = 0; i + 1 < 12; ++i) connect(i + 1, i);
    for (std::size_t i = 0; i < 12; ++i) connect(i, (i + 5) % 12);
    connect(3, 4);
    connect(4, 3);

    const Eigen::Isometry3d first = graph.poses()[0];
    const auto expected = test::gaussNewton(graph, 20);
    const double initial = test::costOf(graph, graph.poses());
    PoseGraph robust = graph;
    const auto result = graph.optimise(withKernel(0));
    EXPECT_NEAR(result.initial_cost, initial, 1e-9 * initial);
    EXPECT_NEAR(result.final_cost, test::costOf(graph, expected), 1e-9 * result.final_cost);
    EXPECT_EQ(graph.poses()[0].matrix(), first.matrix());
    const auto poses = graph.poses();
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT((poses[i].matrix() - expected[i].matrix()).cwiseAbs().maxCoeff(), 1e-6);

    robust.optimise(withKernel(1));
    const auto gradient = test::gradientOf(robust, robust.poses(), 1);
    EXPECT_LT(gradient.tail(gradient.size() - 6).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(PoseGraph, ThousandsOfNodes) {
    PoseGraph graph = drive(4500);
    const auto result = graph.optimise({});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.iterations, 40U);
    const auto again = graph.optimise({});
    EXPECT_NEAR(again.final_cost, result.final_cost, 1e-6 * result.final_cost);
}

TEST(PoseGraph, StopsAtItsLimitAndSaysSo) {
    PoseGraph graph = drive(100);
    auto options = withKernel(10);
    options.max_iterations = 1;
    const auto result = graph.optimise(options);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, 1U);
    EXPECT_LT(result.final_cost, result.initial_cost);
}

TEST(PoseGraph, NothingToDoIsNoError) {
    PoseGraph graph;
    graph.addNode(Eigen::Isometry3d::Identity());
    const auto result = graph.optimise({});
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(result.final_cost, 0);
    graph.addNode(poseAt(1, 0, 0, 0, 0, 0));
    graph.addEdge(edgeOf(0, 1, poseAt(1, 0, 0, 0, 0, 0), std::vector<double>(6, 1e-4)));
    EXPECT_EQ(graph.optimise({}).final_cost, 0);
}

TEST(PoseGraph, EachFaultIsNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> fine(6, 1e-4);
    PoseGraph graph;
    EXPECT_NE(faultOf([&] { graph.optimise({}); }).find("no nodes"), std::string::npos);
    for (int i = 0; i < 5; ++i) graph.addNode(Eigen::Isometry3d::Identity());
    const auto fault = [&](std::size_t from, std::size_t to, const Eigen::Isometry3d& measured,
                           const std::vector<double>& variances) {
        return faultOf([&] { graph.addEdge(edgeOf(from, to, measured, variances)); });
    };
    EXPECT_NE(
        fault(1, 7, Eigen::Isometry3d::Identity(), fine).find("node 7 refers to missing nodes"),
        std::string::npos);
    EXPECT_NE(fault(1, 1, Eigen::Isometry3d::Identity(), fine).find("to itself"),
              std::string::npos);
    EXPECT_NE(fault(1, 2, poseAt(nan, 0, 0, 0, 0, 0), fine).find("node 1 to node 2 is not finite"),
              std::string::npos);
    EXPECT_NE(fault(1, 2, poseAt(1e300, 0, 0, 0, 0, 0), fine).find("exceeds 1e9 m"),
              std::string::npos);
    for (const double bad : {0.0, -1.0, nan, 1e-320, 1e-30})
        EXPECT_NE(fault(1, 2, Eigen::Isometry3d::Identity(), {1, 1, 1, 1, 1, bad})
                      .find("node 1 to node 2"),
                  std::string::npos)
            << bad;
    Matrix6 lopsided = Matrix6::Identity();
    lopsided(0, 5) = 0.1;
    EXPECT_NE(faultOf([&] {
                  graph.addEdge(0, 1, Eigen::Isometry3d::Identity(), lopsided);
              }).find("symmetric"),
              std::string::npos);
    EXPECT_NE(faultOf([&] { graph.addNode(poseAt(0, nan, 0, 0, 0, 0)); }).find("node 5"),
              std::string::npos);
    EXPECT_TRUE(graph.edges().empty());
    EXPECT_EQ(graph.poses().size(), 5U);

    graph.addEdge(edgeOf(0, 1, Eigen::Isometry3d::Identity(), fine));
    graph.addEdge(edgeOf(2, 1, Eigen::Isometry3d::Identity(), fine));
    graph.addEdge(edgeOf(3, 4, Eigen::Isometry3d::Identity(), fine));
    const auto before = graph.poses();
    EXPECT_NE(faultOf([&] { graph.optimise({}); }).find("connects node 3 to node 0"),
              std::string::npos);
    EXPECT_NE(faultOf([&] { graph.optimiseLast(2, {}); }).find("connects node 3"),
              std::string::npos);
    expectSame(graph.poses(), before);
}

TEST(PoseGraph, OptionsAreReadStrictly) {
    const auto load = [](const std::string& text) {
        graph::PoseGraphOptions options;
        options.loadFromConfigFile(mrpt::config::CConfigFileMemory("[graph]\n" + text + "\n"),
                                   "graph");
        return options;
    };
    EXPECT_EQ(load("kernel_width = 3.5").kernel_width, 3.5);
    EXPECT_EQ(load("skip_edges = 3").skip_edges, 3U);
    EXPECT_EQ(load("window = 0").window, 0U);
    EXPECT_THROW(load("min_overlap = 1.1"), Error);
    EXPECT_THROW(load("kernel_width = -1"), Error);
    EXPECT_THROW(load("max_iterations = 0"), Error);
    EXPECT_THROW(load("kernel = 1"), Error);
}
}  // namespace
