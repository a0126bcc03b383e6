// The pose graph while driving: its last nodes are optimised.
#include <gtest/gtest.h>

#include "pose_graph_drive.h"

namespace {
using namespace delio;
using namespace delio::pose_graph_test;

TEST(PoseGraph, OnlyTheLastNodesMove) {
    PoseGraph graph = drive(60);
    const auto before = graph.poses();
    const auto result = graph.optimiseLast(10, {});
    EXPECT_LT(result.final_cost, result.initial_cost);
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(graph.poses()[i].matrix(), before[i].matrix());
    for (std::size_t i = 50; i < 60; ++i)
        EXPECT_GT(test::metresBetween(graph.poses()[i], before[i]), 1e-5);

    // A window over everything is the optimum.
    PoseGraph all = drive(60), optimum = drive(60);
    all.optimiseLast(1000, {});
    optimum.optimise({});
    EXPECT_LT(largestDistance(all.poses(), optimum.poses()), 1e-6);
    EXPECT_EQ(all.poses()[0].matrix(), before[0].matrix());

    PoseGraph elsewhere;  // node 0 is not at the origin
    elsewhere.addNode(poseAt(5, 4, 3, 0.3, 0.2, 0.1));
    for (std::size_t i = 1; i < 6; ++i) {
        elsewhere.addNode(poseAt(5 + static_cast<double>(i), 4, 3, 0.3, 0, 0));
        elsewhere.addEdge(edgeOf(i - 1, i, poseAt(1, 0, 0, 0, 0, 0), std::vector<double>(6, 1e-4)));
    }
    const auto start = elsewhere.poses();
    elsewhere.optimiseLast(2, {});
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(elsewhere.poses()[i].matrix(), start[i].matrix());
    EXPECT_GT(test::metresBetween(elsewhere.poses()[5], start[5]), 0.1);
}

// What a drive does: a node, its edges, the window, and so on.
TEST(PoseGraph, AWindowWhileDrivingComesNearTheOptimum) {
    PoseGraph whole = drive(100), graph;
    whole.optimise({});
    const PoseGraph original = drive(100);
    graph.addNode(original.poses()[0]);
    for (std::size_t i = 1; i < 100; ++i) {
        for (const auto& edge : original.edges()) {
            if (edge.to != i) continue;
            if (edge.from == i - 1) graph.addNode(graph.poses().back() * edge.increment.pose);
            graph.addEdge(edge);
        }
        graph.optimiseLast(10, {});
    }
    EXPECT_LT(largestDistance(whole.poses(), graph.poses()), 0.02);
    EXPECT_GT(largestDistance(whole.poses(), original.poses()), 0.05);
}

}  // namespace
