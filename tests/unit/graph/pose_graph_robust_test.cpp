// The pose graph where edges are wrong, or the start is far off.
#include <gtest/gtest.h>

#include <cmath>

#include "gauss_newton.h"
#include "pose_graph_drive.h"

namespace {
using namespace delio;
using namespace delio::pose_graph_test;

// Without the kernel that edge pulls the drive together (MRPT's own optimiser: by 37 m in such a
// case).
TEST(PoseGraph, OneWrongEdgeMovesNothingUnderTheKernel) {
    PoseGraph right = drive(200);
    right.optimise({});
    PoseGraph wrong = drive(200);
    const auto start = wrong.poses();
    wrong.addEdge(edgeOf(20, 180, poseAt(0, 0, 0, 1, 0, 0), std::vector<double>(6, 1e-6)));
    const auto result = wrong.optimise({});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.final_cost, result.initial_cost);
    EXPECT_GT(largestDistance(right.poses(), start), 0.01);  // so there was something to do
    EXPECT_LT(largestDistance(right.poses(), wrong.poses()), 0.01);
    const auto gradient = test::gradientOf(wrong, wrong.poses(), 10);
    EXPECT_LT(gradient.tail(gradient.size() - 6).cwiseAbs().maxCoeff(), 0.1);

    wrong.optimise(withKernel(0));
    EXPECT_GT(largestDistance(right.poses(), wrong.poses()), 1.0);
}

// Wherever it lies: short or long, backwards, beside a right edge, or as precise as can be.
TEST(PoseGraph, OneGrossEdgeMovesNoPoseByFiveCentimetres) {
    PoseGraph right = drive(200);
    right.optimise({});
    const std::vector<std::pair<std::size_t, std::size_t>> places = {
        {50, 51}, {51, 50}, {50, 52}, {50, 53}, {50, 60}, {0, 199}, {199, 0}, {120, 40}};
    for (const auto& [from, to] : places)
        for (const double variance : {1e-4, 1e-8})
            for (const Eigen::Isometry3d& gross :
                 {poseAt(-7, 3, 1, 1, 0, 0), poseAt(100, 0, 0, 0, 0, 3),
                  poseAt(1, 0.5, 0, 0.2, 0, 0)}) {
                PoseGraph wrong = drive(200);
                wrong.addEdge(edgeOf(from, to, gross, std::vector<double>(6, variance)));
                wrong.optimise({});
                EXPECT_LT(largestDistance(right.poses(), wrong.poses()), 0.05)
                    << from << " " << to << " " << variance << " " << gross.matrix();
            }
}

// The poses that the optimisation starts at were made of it.
TEST(PoseGraph, AWrongStepOfTheChainIsOutvotedByTheEdgesOverIt) {
    PoseGraph right = drive(200);
    right.optimise({});
    PoseGraph graph;
    const PoseGraph original = drive(200);
    graph.addNode(original.poses()[0]);
    for (const auto& edge : original.edges()) {
        if (edge.to != edge.from + 1) continue;
        graph::Edge step = edge;
        if (edge.from == 100) step.increment.pose = poseAt(4, 2, 0, 0.5, 0, 0);
        graph.addNode(graph.poses().back() * step.increment.pose);
        graph.addEdge(step);
    }
    for (const auto& edge : original.edges())
        if (edge.to == edge.from + 2) graph.addEdge(edge);
    EXPECT_GT(largestDistance(right.poses(), graph.poses()), 10);
    graph.optimise({});
    EXPECT_LT(largestDistance(right.poses(), graph.poses()), 0.05);
}

/** A closed round of 1000 m whose odometry ends some 10 m beside its start, as its covariances
 *  say; the first 20 nodes are seen again at the end. */
PoseGraph round(Poses& truth) {
    const std::size_t n = 1020;
    PoseGraph graph;
    truth.assign(1, Eigen::Isometry3d::Identity());
    graph.addNode(truth[0]);
    const std::vector<double> variances{1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6};
    for (std::size_t i = 1; i < n; ++i) {
        const Eigen::Isometry3d step = poseAt(1, 0, 0, 2 * M_PI / 1000, 0, 0);
        truth.push_back(truth.back() * step);
        const Eigen::Isometry3d measured = step * poseAt(0.001, 0, 0, 4e-5, 2e-5, 0);
        graph.addNode(graph.poses().back() * measured);
        graph.addEdge(edgeOf(i - 1, i, measured, variances));
    }
    return graph;
}

// With a kernel of ten standard deviations from the start, closures of 1 cm would be left out.
TEST(PoseGraph, LoopsCloseAfterMetresOfDrift) {
    Poses truth;
    PoseGraph graph = round(truth);
    const std::vector<double> sure(6, 1e-6);
    EXPECT_GT(largestDistance(truth, graph.poses()), 6);
    for (std::size_t i = 0; i < 20; i += 10)
        graph.addEdge(edgeOf(i, 1000 + i, truth[i].inverse() * truth[1000 + i], sure));
    PoseGraph wrong = graph;
    graph.optimise({});
    EXPECT_LT(test::metresBetween(graph.poses()[0], graph.poses()[1000]), 0.02);
    EXPECT_LT(largestDistance(truth, graph.poses()), 2);

    wrong.addEdge(edgeOf(100, 700, poseAt(1, 0, 0, 0, 0, 0), sure));
    wrong.optimise({});
    EXPECT_LT(largestDistance(graph.poses(), wrong.poses()), 0.05);
}
}  // namespace
