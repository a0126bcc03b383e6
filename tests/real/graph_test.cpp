#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>
#include <mrpt/graphslam/levmarq.h>

#include <iostream>

#include "delio/formats/g2o.h"
#include "gauss_newton.h"
#include "test_data.h"

namespace {
using namespace delio;

/** Optimises a public graph without a kernel from the poses in its file; the least cost is known
 *  from undamped Gauss-Newton steps taken by other code, here where that converges. */
void expectTheMinimum(const std::string& file, double leastCost, int gaussNewtonSteps) {
    auto graph = io::loadG2o(test::dataFolder() / file);
    if (gaussNewtonSteps > 0) {
        const auto expected = test::gaussNewton(graph, gaussNewtonSteps);
        EXPECT_NEAR(test::costOf(graph, expected), leastCost, 1e-6 * leastCost);
    }
    graph::PoseGraphOptions options;
    options.kernel_width = 0;
    const auto result = graph.optimise(options);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.final_cost, leastCost, 1e-6 * leastCost);

    const auto& poses = graph.poses();
    EXPECT_NEAR(test::costOf(graph, poses), result.final_cost, 1e-9 * leastCost);
    const auto gradient = test::gradientOf(graph, poses, 0);
    const double largest = gradient.tail(gradient.size() - 6).cwiseAbs().maxCoeff();
    EXPECT_LT(largest, 1e-3);
    std::cout << file << ": " << result.iterations << " iterations, largest gradient " << largest
              << "\n";
}

TEST(Graph, ParkingGarage) {
    DELIO_NEED_DATA("graphs/parking-garage.g2o");
    expectTheMinimum("graphs/parking-garage.g2o", 1.238690598, 8);
}

TEST(Graph, Sphere2500) {
    DELIO_NEED_DATA("graphs/sphere2500.g2o");
    expectTheMinimum("graphs/sphere2500.g2o", 727.2388518, 12);
}

TEST(Graph, SmallGrid3D) {
    DELIO_NEED_DATA("graphs/smallGrid3D.g2o");
    expectTheMinimum("graphs/smallGrid3D.g2o", 462.4825302, 40);
}

// A chain with nothing in conflict: every edge can be met, as MRPT's stored answer does.
TEST(Graph, Torus) {
    DELIO_NEED_DATA("graphs/graphslam_SE3_in_torus3D-first100.graph");
    auto graph = io::loadG2o(test::dataFolder() / "graphs/graphslam_SE3_in_torus3D-first100.graph");
    const auto result = graph.optimise({});
    EXPECT_GT(result.initial_cost, 1);
    EXPECT_LT(result.final_cost, 1e-6);
    const auto answer =
        io::loadG2o(test::dataFolder() / "graphs/graphslam_SE3_out_good_torus3D-first100.graph");
    ASSERT_EQ(answer.poses().size(), graph.poses().size());
    for (std::size_t i = 0; i < graph.poses().size(); ++i)
        EXPECT_LT(toMrpt(graph.poses()[i]).distanceEuclidean6D(toMrpt(answer.poses()[i])), 1e-3)
            << i;
}

/** The same graph with unit information, optimised by both; what counts is the sum of squares that
 *  MRPT reports, which takes no information into account (as its graph-slam --levmarq --3d). */
void expectNoWorseThanMrpt(const std::string& file) {
    const std::string path = test::dataFolder() / file;
    mrpt::graphs::CNetworkOfPoses3D network;
    network.loadFromTextFile(path);
    network.root = network.nodes.begin()->first;
    auto ours = network;
    mrpt::graphslam::TResultInfoSpaLevMarq info;
    mrpt::graphslam::optimize_graph_spa_levmarq(network, info);

    const auto loaded = io::loadG2o(path);
    graph::PoseGraph graph;
    for (const auto& pose : loaded.poses()) graph.addNode(pose);
    for (const auto& edge : loaded.edges())
        graph.addEdge(edge.from, edge.to, edge.increment.pose, Matrix6::Identity());
    graph::PoseGraphOptions options;
    options.kernel_width = 0;
    graph.optimise(options);
    ASSERT_EQ(ours.nodes.size(), graph.poses().size());
    std::size_t i = 0;
    for (auto& [id, node] : ours.nodes) node = toMrpt(graph.poses()[i++]);
    const double mrpts = network.getGlobalSquareError(true), mine = ours.getGlobalSquareError(true);
    std::cout << file << ": MRPT " << mrpts << ", DeLiO " << mine << "\n";
    EXPECT_LE(mine, 1.001 * mrpts);
}

TEST(Graph, NoWorseThanMrptByItsOwnError) {
    for (const std::string file :
         {"graphs/parking-garage.g2o", "graphs/sphere2500.g2o", "graphs/smallGrid3D.g2o"}) {
        DELIO_NEED_DATA(file);
        expectNoWorseThanMrpt(file);
    }
}
}  // namespace
