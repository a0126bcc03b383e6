// The pose graph while driving: its last nodes are optimised, and taken back.
#include <gtest/gtest.h>

#include <limits>
#include <utility>

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

/** The graph as it is, to the bit. */
void expectSameGraph(const PoseGraph& a, const PoseGraph& b) {
    expectSame(a.poses(), b.poses());
    ASSERT_EQ(a.edges().size(), b.edges().size());
    for (std::size_t i = 0; i < a.edges().size(); ++i) {
        EXPECT_EQ(a.edges()[i].from, b.edges()[i].from);
        EXPECT_EQ(a.edges()[i].to, b.edges()[i].to);
        EXPECT_EQ(a.edges()[i].increment.pose.matrix(), b.edges()[i].increment.pose.matrix());
        EXPECT_EQ(a.edges()[i].increment.covariance, b.edges()[i].increment.covariance);
        EXPECT_EQ(a.information(i), b.information(i));
    }
}

/** Node `i` of `whole` with its edges to earlier ones. */
void addNodeOf(const PoseGraph& whole, std::size_t i, PoseGraph& graph) {
    graph.addNode(whole.poses()[i]);
    for (const auto& edge : whole.edges())
        if (edge.to == i) graph.addEdge(edge);
}

// What a scan that failed half-way has to leave behind.
TEST(PoseGraph, ANodeThatIsTakenBackWasNeverThere) {
    const PoseGraph whole = drive(30);
    PoseGraph never, taken;
    for (std::size_t i = 0; i < 30; ++i) {
        addNodeOf(whole, i, never);
        if (i > 0) never.optimiseLast(10, {});

        addNodeOf(whole, i, taken);
        const auto before = taken.poses();
        if (i > 0) taken.optimiseLast(10, {});
        const std::size_t first = i > 9 ? i - 9 : 0;
        taken.removeLast();
        taken.restore(first,
                      {before.begin() + static_cast<std::ptrdiff_t>(first), before.end() - 1});
        EXPECT_EQ(taken.poses().size(), i);
        addNodeOf(whole, i, taken);
        if (i > 0) taken.optimiseLast(10, {});
    }
    expectSameGraph(taken, never);
    taken.optimise({});
    never.optimise({});
    expectSameGraph(taken, never);
}

// Its edges lie between those of other nodes, and lead both ways.
TEST(PoseGraph, TheLastNodeGoesWithItsEdgesWhereverTheyAre) {
    const std::vector<double> sure(6, 1e-4), unsure(6, 1e-2);
    PoseGraph graph, expected;
    for (double x = 0; x < 4; ++x) graph.addNode(poseAt(x, 0, 0, 0));
    for (double x = 0; x < 3; ++x) expected.addNode(poseAt(x, 0, 0, 0));
    const auto edge = [&](std::size_t from, std::size_t to, const std::vector<double>& variances) {
        return edgeOf(from, to,
                      poseAt(static_cast<double>(to) - static_cast<double>(from), 0.1, 0, 0),
                      variances);
    };
    for (const auto& [from, to] : std::vector<std::pair<std::size_t, std::size_t>>{
             {3, 0}, {0, 1}, {1, 3}, {1, 2}, {2, 3}, {2, 0}, {3, 2}, {0, 2}}) {
        const auto& variances = from > to ? sure : unsure;
        graph.addEdge(edge(from, to, variances));
        if (from != 3 && to != 3) expected.addEdge(edge(from, to, variances));
    }
    graph.removeLast();
    expectSameGraph(graph, expected);
    const auto result = graph.optimise({});
    EXPECT_EQ(result.final_cost, expected.optimise({}).final_cost);
    expectSameGraph(graph, expected);

    for (int i = 0; i < 3; ++i) graph.removeLast();
    EXPECT_TRUE(graph.poses().empty());
    EXPECT_TRUE(graph.edges().empty());
    EXPECT_NE(faultOf([&] { graph.removeLast(); }).find("no nodes"), std::string::npos);
}

TEST(PoseGraph, PosesThatCannotBePutBackChangeNothing) {
    PoseGraph graph = drive(5);
    const auto before = graph.poses();
    const Poses two(2, poseAt(7, 8, 9, 1));
    EXPECT_NE(faultOf([&] { graph.restore(4, two); }).find("not there"), std::string::npos);
    EXPECT_NE(faultOf([&] { graph.restore(9, {}); }).find("not there"), std::string::npos);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(faultOf([&] {
                  graph.restore(2, {two[0], poseAt(nan, 0, 0, 0)});
              }).find("node 3"),
              std::string::npos);
    expectSame(graph.poses(), before);
    graph.restore(5, {});
    expectSame(graph.poses(), before);
    graph.restore(3, two);
    expectSame(graph.poses(), {before[0], before[1], before[2], two[0], two[1]});
}
}  // namespace
