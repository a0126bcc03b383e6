#include "delio/graph/pose_graph.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>

#include <cmath>
#include <limits>
#include <random>

#include "delio/error.h"
#include "gauss_newton.h"

namespace {
using namespace delio;
using graph::Matrix6;
using graph::PoseGraph;
using mrpt::poses::CPose3D;

CPose3D pose(double x, double y, double z, double yaw, double pitch, double roll) {
    return CPose3D::FromXYZYawPitchRoll(x, y, z, yaw, pitch, roll);
}

graph::PoseGraphOptions withKernel(double width) {
    graph::PoseGraphOptions options;
    options.kernel_width = width;
    return options;
}

graph::Edge edgeOf(std::size_t from, std::size_t to, const CPose3D& measured,
                   const std::vector<double>& variances) {
    graph::Edge edge{from, to, {measured, {}}};
    for (int i = 0; i < 6; ++i)
        edge.increment.covariance(i, i) = variances[static_cast<std::size_t>(i)];
    return edge;
}

/** Numbers that are the same wherever the test runs, which std's distributions are not. */
class Noise {
 public:
    double operator()() { return static_cast<double>(engine_()) / 2147483648.0 - 1; }  // [-1, 1)
    CPose3D pose(double metres, double radians) {
        const double x = metres * (*this)(), y = metres * (*this)(), z = metres * (*this)();
        const double a = radians * (*this)(), b = radians * (*this)(), c = radians * (*this)();
        return ::pose(x, y, z, a, b, c);
    }
    Matrix6 information() {
        Matrix6 m;
        for (int i = 0; i < 36; ++i) m(i) = (*this)();
        return m * m.transpose() + Matrix6::Identity();
    }

 private:
    std::mt19937 engine_{7};
};

/** A drive of n nodes on a wide curve, edges (i,i+1) and (i,i+2), starting as odometry would. */
PoseGraph drive(std::size_t n) {
    Noise noise;
    std::vector<CPose3D> truth{CPose3D()};
    while (truth.size() < n) truth.push_back(truth.back() + pose(0.9, 0, 0, 0.01, 0, 0));
    const auto measured = [&](std::size_t i, std::size_t j) {
        return (truth[j] - truth[i]) + noise.pose(0.02, 0.001);
    };
    const std::vector<double> variances{1e-4, 1e-4, 1e-4, 3e-7, 3e-7, 3e-7};
    PoseGraph graph;
    graph.addNode(truth[0]);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const CPose3D step = measured(i, i + 1);
        graph.addNode(graph.poses()[i] + step);
        graph.addEdge(edgeOf(i, i + 1, step, variances));
    }
    for (std::size_t i = 0; i + 2 < n; ++i)
        graph.addEdge(edgeOf(i, i + 2, measured(i, i + 2), variances));
    return graph;
}

double largestDistance(const std::vector<CPose3D>& a, const std::vector<CPose3D>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, a[i].distanceTo(b[i]));
    return largest;
}

std::string faultOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

// MRPT's own optimiser stays at 0.5 here: without its information matrix, that is the minimum.
TEST(PoseGraph, EdgesInConflictMeetWhereTheirInformationSays) {
    for (const double start : {0.5, -30.0, 1.0}) {
        PoseGraph graph;
        graph.addNode(CPose3D());
        graph.addNode(pose(start, 0, 0, 0.3, 0.2, 0.1));
        graph.addEdge(0, 1, CPose3D(), 100 * Matrix6::Identity());
        graph.addEdge(0, 1, pose(1, 0, 0, 0, 0, 0), Matrix6::Identity());
        const auto result = graph.optimise(withKernel(0));
        EXPECT_NEAR(graph.poses()[1].x(), 1.0 / 101, 1e-9);
        EXPECT_NEAR(result.final_cost, 100.0 / 101, 1e-9);
        EXPECT_TRUE(result.converged);
    }
}

// Without the kernel that edge pulls the drive together (MRPT's own optimiser: by 37 m in such a
// case).
TEST(PoseGraph, OneWrongEdgeMovesNothingUnderTheKernel) {
    PoseGraph right = drive(200);
    right.optimise({});
    PoseGraph wrong = drive(200);
    const auto start = wrong.poses();
    wrong.addEdge(edgeOf(20, 180, pose(0, 0, 0, 1, 0, 0), std::vector<double>(6, 1e-6)));
    const auto result = wrong.optimise({});
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.final_cost, result.initial_cost);
    EXPECT_GT(largestDistance(right.poses(), start), 0.01);  // so there was something to do
    EXPECT_LT(largestDistance(right.poses(), wrong.poses()), 0.01);
    const auto gradient = test::gradientOf(wrong, test::isometriesOf(wrong.poses()), 10);
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
            for (const CPose3D& gross :
                 {pose(-7, 3, 1, 1, 0, 0), pose(100, 0, 0, 0, 0, 3), pose(1, 0.5, 0, 0.2, 0, 0)}) {
                PoseGraph wrong = drive(200);
                wrong.addEdge(edgeOf(from, to, gross, std::vector<double>(6, variance)));
                wrong.optimise({});
                EXPECT_LT(largestDistance(right.poses(), wrong.poses()), 0.05)
                    << from << " " << to << " " << variance << " " << gross;
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
        if (edge.from == 100) step.increment.pose = pose(4, 2, 0, 0.5, 0, 0);
        graph.addNode(graph.poses().back() + step.increment.pose);
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
PoseGraph round(std::vector<CPose3D>& truth) {
    const std::size_t n = 1020;
    PoseGraph graph;
    truth.assign(1, CPose3D());
    graph.addNode(truth[0]);
    const std::vector<double> variances{1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6};
    for (std::size_t i = 1; i < n; ++i) {
        const CPose3D step = pose(1, 0, 0, 2 * M_PI / 1000, 0, 0);
        truth.push_back(truth.back() + step);
        const CPose3D measured = step + pose(0.001, 0, 0, 4e-5, 2e-5, 0);
        graph.addNode(graph.poses().back() + measured);
        graph.addEdge(edgeOf(i - 1, i, measured, variances));
    }
    return graph;
}

// With a kernel of ten standard deviations from the start, closures of 1 cm would be left out.
TEST(PoseGraph, LoopsCloseAfterMetresOfDrift) {
    std::vector<CPose3D> truth;
    PoseGraph graph = round(truth);
    const std::vector<double> sure(6, 1e-6);
    EXPECT_GT(largestDistance(truth, graph.poses()), 6);
    for (std::size_t i = 0; i < 20; i += 10)
        graph.addEdge(edgeOf(i, 1000 + i, truth[1000 + i] - truth[i], sure));
    PoseGraph wrong = graph;
    graph.optimise({});
    EXPECT_LT(graph.poses()[0].distanceTo(graph.poses()[1000]), 0.02);
    EXPECT_LT(largestDistance(truth, graph.poses()), 2);

    wrong.addEdge(edgeOf(100, 700, pose(1, 0, 0, 0, 0, 0), sure));
    wrong.optimise({});
    EXPECT_LT(largestDistance(graph.poses(), wrong.poses()), 0.05);
}

TEST(PoseGraph, OnlyTheLastNodesMove) {
    PoseGraph graph = drive(60);
    const auto before = graph.poses();
    const auto result = graph.optimiseLast(10, {});
    EXPECT_LT(result.final_cost, result.initial_cost);
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(graph.poses()[i], before[i]);
    for (std::size_t i = 50; i < 60; ++i) EXPECT_GT(graph.poses()[i].distanceTo(before[i]), 1e-5);

    // A window over everything is the optimum.
    PoseGraph all = drive(60), optimum = drive(60);
    all.optimiseLast(1000, {});
    optimum.optimise({});
    EXPECT_LT(largestDistance(all.poses(), optimum.poses()), 1e-6);
    EXPECT_EQ(all.poses()[0], before[0]);

    PoseGraph elsewhere;  // node 0 is not at the origin
    elsewhere.addNode(pose(5, 4, 3, 0.3, 0.2, 0.1));
    for (std::size_t i = 1; i < 6; ++i) {
        elsewhere.addNode(pose(5 + static_cast<double>(i), 4, 3, 0.3, 0, 0));
        elsewhere.addEdge(edgeOf(i - 1, i, pose(1, 0, 0, 0, 0, 0), std::vector<double>(6, 1e-4)));
    }
    const auto start = elsewhere.poses();
    elsewhere.optimiseLast(2, {});
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(elsewhere.poses()[i], start[i]);
    EXPECT_GT(elsewhere.poses()[5].distanceTo(start[5]), 0.1);
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
            if (edge.from == i - 1) graph.addNode(graph.poses().back() + edge.increment.pose);
            graph.addEdge(edge);
        }
        graph.optimiseLast(10, {});
    }
    EXPECT_LT(largestDistance(whole.poses(), graph.poses()), 0.02);
    EXPECT_GT(largestDistance(whole.poses(), original.poses()), 0.05);
}

TEST(PoseGraph, JacobiansAreThoseOfTheResidual) {
    Noise noise;
    for (const double angle : {1e-9, 1e-5, 0.3, 1.5}) {
        for (int round = 0; round < 20; ++round) {
            const CPose3D from = noise.pose(50, 3);
            const CPose3D measured = noise.pose(5, 3);
            const CPose3D to = from + measured + noise.pose(angle, angle);
            const auto Z = test::isometryOf(measured);
            const auto A = test::isometryOf(from);
            const auto B = test::isometryOf(to);
            const auto r = graph::residualOf(measured, from, to);
            EXPECT_LT((r.error - test::errorOf(Z, A, B)).norm(), 1e-12);
            const double h = 1e-6;
            for (int k = 0; k < 6; ++k) {
                const test::Vector6d d = h * test::Vector6d::Unit(k);
                const test::Vector6d byFrom = (test::errorOf(Z, test::moved(A, d), B) -
                                               test::errorOf(Z, test::moved(A, -d), B)) /
                                              (2 * h);
                const test::Vector6d byTo = (test::errorOf(Z, A, test::moved(B, d)) -
                                             test::errorOf(Z, A, test::moved(B, -d))) /
                                            (2 * h);
                EXPECT_LT((r.dFrom.col(k) - byFrom).norm(), 1e-7);
                EXPECT_LT((r.dTo.col(k) - byTo).norm(), 1e-7);
            }
        }
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
            const CPose3D differing = pose(e[0], e[1], e[2], e[5], e[4], e[3]);
            PoseGraph graph;
            graph.addNode(CPose3D());
            graph.addNode(CPose3D());
            graph.addEdge(edgeOf(0, 1, CPose3D(), sure));
            graph.addEdge(edgeOf(0, 1, differing, unsure));
            graph.optimise(withKernel(0));
            const CPose3D& end = graph.poses()[1];
            const double moved = axis < 3
                                     ? end[static_cast<unsigned>(axis)]
                                     : std::vector{end.roll(), end.pitch(), end.yaw()}[axis - 3];
            EXPECT_NEAR(moved, disagreement * 1e-4 / (1 + 1e-4), 1e-9) << axis << " " << other;
        }
    }
}

// The later frame is turned left by 90 degrees: its x is the earlier frame's y.
TEST(PoseGraph, CovariancesAreInTheLaterFrame) {
    PoseGraph graph;
    graph.addNode(CPose3D());
    graph.addNode(CPose3D());
    graph.addEdge(edgeOf(0, 1, pose(0, 0, 0, M_PI / 2, 0, 0), {1e-4, 1, 1, 1, 1, 1}));
    graph.addEdge(edgeOf(0, 1, pose(0.2, 0.2, 0, M_PI / 2, 0, 0), {1, 1e-4, 1, 1, 1, 1}));
    graph.optimise(withKernel(0));
    EXPECT_NEAR(graph.poses()[1].y(), 0.2 * 1e-4 / (1 + 1e-4), 1e-9);
    EXPECT_NEAR(graph.poses()[1].x(), 0.2 / (1 + 1e-4), 1e-9);
}

TEST(PoseGraph, AgreesWithBruteForceAndNode0Stays) {
    Noise noise;
    PoseGraph graph;
    std::vector<CPose3D> truth;
    for (int i = 0; i < 12; ++i) {
        truth.push_back(noise.pose(5, 3));
        graph.addNode(truth.back() + noise.pose(0.3, 0.2));
    }
    const auto connect = [&](std::size_t i, std::size_t j) {
        graph.addEdge(i, j, (truth[j] - truth[i]) + noise.pose(0.1, 0.1), noise.information());
    };
    // Backwards, twice over, and all round.
    for (std::size_t i = 0; i + 1 < 12; ++i) connect(i + 1, i);
    for (std::size_t i = 0; i < 12; ++i) connect(i, (i + 5) % 12);
    connect(3, 4);
    connect(4, 3);

    const CPose3D first = graph.poses()[0];
    const auto expected = test::gaussNewton(graph, 20);
    const double initial = test::costOf(graph, test::isometriesOf(graph.poses()));
    PoseGraph robust = graph;
    const auto result = graph.optimise(withKernel(0));
    EXPECT_NEAR(result.initial_cost, initial, 1e-9 * initial);
    EXPECT_NEAR(result.final_cost, test::costOf(graph, expected), 1e-9 * result.final_cost);
    EXPECT_EQ(graph.poses()[0].getRotationMatrix(), first.getRotationMatrix());
    EXPECT_EQ(graph.poses()[0].m_coords, first.m_coords);
    const auto poses = test::isometriesOf(graph.poses());
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT((poses[i].matrix() - expected[i].matrix()).cwiseAbs().maxCoeff(), 1e-6);

    robust.optimise(withKernel(1));
    const auto gradient = test::gradientOf(robust, test::isometriesOf(robust.poses()), 1);
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
    graph.addNode(CPose3D());
    const auto result = graph.optimise({});
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(result.final_cost, 0);
    graph.addNode(pose(1, 0, 0, 0, 0, 0));
    graph.addEdge(edgeOf(0, 1, pose(1, 0, 0, 0, 0, 0), std::vector<double>(6, 1e-4)));
    EXPECT_EQ(graph.optimise({}).final_cost, 0);
}

TEST(PoseGraph, EachFaultIsNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> fine(6, 1e-4);
    PoseGraph graph;
    EXPECT_NE(faultOf([&] { graph.optimise({}); }).find("no nodes"), std::string::npos);
    for (int i = 0; i < 5; ++i) graph.addNode(CPose3D());
    const auto fault = [&](std::size_t from, std::size_t to, const CPose3D& measured,
                           const std::vector<double>& variances) {
        return faultOf([&] { graph.addEdge(edgeOf(from, to, measured, variances)); });
    };
    EXPECT_NE(fault(1, 7, CPose3D(), fine).find("node 7 needs nodes that are not there"),
              std::string::npos);
    EXPECT_NE(fault(1, 1, CPose3D(), fine).find("to itself"), std::string::npos);
    EXPECT_NE(fault(1, 2, pose(nan, 0, 0, 0, 0, 0), fine).find("node 1 to node 2 is not finite"),
              std::string::npos);
    EXPECT_NE(fault(1, 2, pose(1e300, 0, 0, 0, 0, 0), fine).find("beyond 1e9 m"),
              std::string::npos);
    for (const double bad : {0.0, -1.0, nan, 1e-320, 1e-30})
        EXPECT_NE(fault(1, 2, CPose3D(), {1, 1, 1, 1, 1, bad}).find("node 1 to node 2"),
                  std::string::npos)
            << bad;
    Matrix6 lopsided = Matrix6::Identity();
    lopsided(0, 5) = 0.1;
    EXPECT_NE(faultOf([&] { graph.addEdge(0, 1, CPose3D(), lopsided); }).find("symmetric"),
              std::string::npos);
    EXPECT_NE(faultOf([&] { graph.addNode(pose(0, nan, 0, 0, 0, 0)); }).find("node 5"),
              std::string::npos);
    EXPECT_TRUE(graph.edges().empty());
    EXPECT_EQ(graph.poses().size(), 5U);

    graph.addEdge(edgeOf(0, 1, CPose3D(), fine));
    graph.addEdge(edgeOf(2, 1, CPose3D(), fine));
    graph.addEdge(edgeOf(3, 4, CPose3D(), fine));
    const auto before = graph.poses();
    EXPECT_NE(faultOf([&] { graph.optimise({}); }).find("connect node 3 to node 0"),
              std::string::npos);
    EXPECT_NE(faultOf([&] { graph.optimiseLast(2, {}); }).find("connect node 3"),
              std::string::npos);
    EXPECT_EQ(graph.poses(), before);
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
