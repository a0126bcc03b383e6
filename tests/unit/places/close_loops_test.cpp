#include "places/close_loops.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <sstream>

#include "town.h"

namespace {
using namespace delio;
using namespace delio::places_test;
using places::ClosedLoops;

double farthest(const Poses& a, const Poses& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, test::metresBetween(a[i], b[i]));
    return most;
}

ClosedLoops closed(const std::vector<places::Submap>& submaps, const Poses& believed,
                   const places::LoopOptions& options = {}) {
    places::LoopSearch search(options, {});
    for (const auto& submap : submaps) search.add(submap, believed[submap.key]);
    return places::closeLoops(chainOf(believed), search, {});
}

/** What became of the candidates, for a test that fails. */
std::string textOf(const ClosedLoops& result) {
    std::ostringstream text;
    for (const auto& loop : result.candidates)
        text << loop.fromNode << " to " << loop.toNode << ", " << loop.path_m << " m: images "
             << loop.imageOverlap << ", planes " << loop.closure.inlierRatio << ", overlap "
             << loop.closure.overlap << ", moved " << loop.moved_m()
             << " m: " << loop.closure.reason << "\n";
    return text.str();
}

/** Round the block and half round again, with a drift of metres, upwards too. */
class ADriveRoundTheBlock : public testing::Test {
 protected:
    static const Poses& truth() {
        static const Poses poses = roundTheBlock(20);
        return poses;
    }
    static const Poses& believed() {
        static const Poses poses = drifted(truth(), 0.03, 0.004, 0.02);
        return poses;
    }
    static const std::vector<places::Submap>& submaps() {
        static const auto made = submapsOf(town(), truth(), believed());
        return made;
    }
};

TEST_F(ADriveRoundTheBlock, IsClosed) {
    const double before = farthest(believed(), truth());
    ASSERT_GT(before, 1.5);
    const auto result = closed(submaps(), believed());
    ASSERT_GE(result.accepted, 2U) << textOf(result);
    EXPECT_LT(farthest(result.graph.poses(), truth()), before / 3);
    EXPECT_EQ(result.graph.edges().size(), truth().size() - 1 + result.accepted);
    EXPECT_GT(result.drift_factor, 1);
    for (const auto& loop : result.candidates) {
        if (!loop.accepted()) continue;
        const Eigen::Isometry3d seen = truth()[loop.fromNode].inverse() * truth()[loop.toNode];
        EXPECT_LT(test::metresBetween(loop.closure.increment.pose, seen), 0.2);
        EXPECT_LT(test::degreesBetween(loop.closure.increment.pose, seen), 0.5);
        const auto& poses = result.graph.poses();
        const Eigen::Isometry3d now = poses[loop.fromNode].inverse() * poses[loop.toNode];
        EXPECT_LT(test::metresBetween(now, seen), 0.2);
    }
}

TEST_F(ADriveRoundTheBlock, HasTheSameLoopsForAnyNumberOfThreads) {
    const auto many = closed(submaps(), believed());
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto single = closed(submaps(), believed());
    ASSERT_EQ(many.graph.poses().size(), single.graph.poses().size());
    for (std::size_t i = 0; i < many.graph.poses().size(); ++i)
        ASSERT_EQ(many.graph.poses()[i].matrix(), single.graph.poses()[i].matrix()) << i;
}

TEST_F(ADriveRoundTheBlock, IsNotClosedASecondTime) {
    const auto first = closed(submaps(), believed());
    places::LoopSearch search({}, {});
    for (const auto& submap : submaps()) search.add(submap, first.graph.poses()[submap.key]);
    const auto second = places::closeLoops(first.graph, search, {});
    EXPECT_EQ(second.graph.edges().size(), first.graph.edges().size());
    EXPECT_LT(farthest(second.graph.poses(), first.graph.poses()), 0.01);
}

// Poses of which nothing is wrong stay.
TEST_F(ADriveRoundTheBlock, ThatDidNotDriftStaysWhereItIs) {
    const auto result = closed(submapsOf(town(), truth(), truth()), truth());
    EXPECT_GE(result.accepted, 2U) << textOf(result);
    EXPECT_LT(farthest(result.graph.poses(), truth()), 0.02);
    EXPECT_LT(result.drift_factor, 0.2);
}

TEST(CloseLoops, ThereAndBackAgain) {
    Poses truth;
    for (int i = 0; i < 40; ++i) truth.push_back(test::poseAt(2 * i - 30, 0, 0));
    for (int i = 0; i < 12; ++i) truth.push_back(truth.back() * test::poseAtDeg(0.4, 0, 0, 15));
    for (int i = 0; i < 38; ++i) truth.push_back(truth.back() * test::poseAt(2, 0, 0));
    const auto believed = drifted(truth, 0.03, 0.004, 0.02);
    const double before = farthest(believed, truth);
    const auto result = closed(submapsOf(town(), truth, believed), believed);
    EXPECT_GE(result.accepted, 2U) << textOf(result);
    EXPECT_LT(farthest(result.graph.poses(), truth), before / 2);
}

// Two drives in one recording: where the second one began is hardly known.
TEST(CloseLoops, AcrossAGap) {
    const auto round = roundTheBlock(0);
    Poses truth = round;
    for (std::size_t i = 0; i < 40; ++i) truth.push_back(round[i] * test::poseAt(1, 0.5, 0));
    Poses believed = truth;
    const Eigen::Isometry3d start = truth[round.size()];
    for (std::size_t i = round.size(); i < truth.size(); ++i)
        believed[i] = start * test::poseAtDeg(4, -6, 1, 8) * start.inverse() * truth[i];
    Increment gap{believed[round.size() - 1].inverse() * believed[round.size()],
                  std::pow(10, 2) * Matrix6::Identity()};
    gap.covariance.bottomRightCorner<3, 3>() = std::pow(0.2, 2) * Eigen::Matrix3d::Identity();
    graph::PoseGraph graph;
    for (const auto& pose : believed) graph.addNode(pose);
    const auto chain = chainOf(believed);
    for (const auto& edge : chain.edges())
        graph.addEdge(edge.to == round.size() ? graph::Edge{edge.from, edge.to, gap} : edge);
    places::LoopSearch search({}, {});
    for (const auto& submap : submapsOf(town(), truth, believed, round.size(), gap))
        search.add(submap, believed[submap.key]);
    const auto result = places::closeLoops(graph, search, {});
    EXPECT_GE(result.accepted, 2U) << textOf(result);
    EXPECT_LT(farthest(result.graph.poses(), truth), 0.2);
    EXPECT_LT(result.drift_factor, 0.3);
}

// Of nothing nothing is found, and nothing breaks.
TEST_F(ADriveRoundTheBlock, WithSubmapsWithoutSurfaces) {
    auto empty = submaps();
    for (auto& submap : empty) submap.points.resize(3, 0);
    EXPECT_EQ(closed(empty, believed()).accepted, 0U);
    auto one = submaps();
    one.front().points.resize(3, 0);
    one.back().points = Eigen::Matrix3Xf::Constant(3, 1, 2);
    EXPECT_LE(closed(one, believed()).accepted, closed(submaps(), believed()).accepted);
}

TEST(CloseLoops, AStraightDriveHasNone) {
    Poses truth;
    for (int i = 0; i < 60; ++i) truth.push_back(test::poseAt(2 * i - 40, 0, 0));
    const auto result = closed(submapsOf(town(), truth, truth), truth);
    EXPECT_EQ(result.accepted, 0U) << textOf(result);
    for (std::size_t i = 0; i < truth.size(); ++i)
        EXPECT_EQ(result.graph.poses()[i].matrix(), truth[i].matrix());
}

// The next street looks the same: it is another one.
TEST(CloseLoops, AStreetLikeAnotherIsNone) {
    Poses truth;
    for (int i = 0; i < 30; ++i) truth.push_back(test::poseAt(2 * i, 0, 0));
    for (const int straight : {0, 17}) {
        for (int i = 0; i < straight; ++i) truth.push_back(truth.back() * test::poseAt(2, 0, 0));
        for (int i = 0; i < 6; ++i) truth.push_back(truth.back() * test::poseAtDeg(0.5, 0, 0, 15));
    }
    while (truth.back().translation().x() > 0)
        truth.push_back(truth.back() * test::poseAt(2, 0, 0));
    const auto result = closed(submapsOf(town(true), truth, truth), truth);
    EXPECT_EQ(result.accepted, 0U) << textOf(result);
}

// An odometry that may be off by so much that a row of identical houses fits, moved by one.
TEST(CloseLoops, AStreetThatRepeatsItselfIsNone) {
    const auto truth = roundTheBlock(20);
    const auto submaps = submapsOf(town(true), truth, truth);
    for (const double drift : {0.03, 0.1}) {
        places::LoopOptions options;
        options.drift = drift;
        const auto result = closed(submaps, truth, options);
        EXPECT_GT(result.candidates.size(), 4U);
        EXPECT_EQ(result.accepted, 0U) << textOf(result);
    }
}

TEST(CloseLoops, ATunnelDrivenThereAndBackIsNone) {
    const test::Scene tunnel{{{-300, -100, -2.8}, {400, 140, -1.8}},
                             {{-300, 4, -2}, {400, 5, 6}},
                             {{-300, -5, -2}, {400, -4, 6}},
                             {{-300, -5, 5}, {400, 5, 6}}};
    Poses truth;
    for (int i = 0; i < 40; ++i) truth.push_back(test::poseAt(2 * i, 0, 0));
    for (int i = 0; i < 12; ++i) truth.push_back(truth.back() * test::poseAtDeg(0.2, 0, 0, 15));
    for (int i = 0; i < 35; ++i) truth.push_back(truth.back() * test::poseAt(2, 0, 0));
    const auto believed = drifted(truth, 0.02, 0.01, 0);
    const auto result = closed(submapsOf(tunnel, truth, believed), believed);
    EXPECT_GT(result.candidates.size(), 0U);
    EXPECT_EQ(result.accepted, 0U) << textOf(result);
}

TEST(CloseLoops, OfNoDriveAreNone) { EXPECT_EQ(closed({}, {test::poseAt(0, 0, 0)}).accepted, 0U); }

using places::LoopCandidate;
using places::Submap;
using places_test::Poses;
using test::poseAt;

/** There and back again along x, 400 m each way, a submap every 20 m. */
class Loops : public testing::Test {
 protected:
    Loops() {
        for (std::size_t i = 0; i < 40; ++i) {
            const double x = 20 * static_cast<double>(i);
            poses.push_back(i < 20 ? poseAt(x, 0, 0) : test::poseAtDeg(780 - x, 0, 0, 180));
            Submap submap;
            submap.first = submap.key = submap.last = i;
            submap.driven.path_m = x;
            submaps.push_back(submap);
        }
    }
    /** Of two submaps, which was found `error` off the truth. */
    void found(std::size_t from, std::size_t to, const Eigen::Isometry3d& error) {
        LoopCandidate loop;
        loop.from = from;
        loop.to = to;
        loop.path_m = submaps[to].driven.path_m - submaps[from].driven.path_m;
        loop.closure.level = poses[from].inverse() * poses[to] * error;
        candidates.push_back(loop);
    }
    std::vector<std::string> reasons() {
        places::refuseInconsistent(candidates, submaps, poses, {});
        std::vector<std::string> texts;
        for (const auto& loop : candidates) texts.push_back(loop.closure.reason);
        return texts;
    }

    Poses poses;
    std::vector<Submap> submaps;
    std::vector<LoopCandidate> candidates;
};

TEST_F(Loops, ThatAgreeAreBelieved) {
    for (const std::size_t i : {3, 4, 5}) found(i, 39 - i, poseAt(1, 0.5, 2));
    EXPECT_EQ(reasons(), std::vector<std::string>(3, ""));
}

TEST_F(Loops, ThatStandAloneAreNot) {
    found(3, 36, poseAt(0, 0, 0));
    found(15, 24, poseAt(0, 0, 0));
    EXPECT_EQ(reasons(), std::vector<std::string>(2, "not confirmed by a neighbouring submap"));
}

TEST_F(Loops, ThatContradictMostAreNot) {
    for (const std::size_t i : {3, 4, 5, 6})
        found(i, 39 - i, i == 5 ? poseAt(6, 0, 0) : poseAt(0, 0, 0));
    EXPECT_EQ(reasons(), (std::vector<std::string>{"", "", "inconsistent with other loops", ""}));
}

TEST_F(Loops, ThatNoDriftExplainsAreNot) {
    for (const std::size_t i : {3, 4, 5}) found(i, 39 - i, poseAt(0, 40, 0));
    EXPECT_EQ(reasons(),
              std::vector<std::string>(3, "farther away than the odometry can have drifted"));
}
}  // namespace
