#include "delio/slam/slam.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "delio/core/error.h"
#include "gauss_newton.h"
#include "odometry/preprocess.h"
#include "slam_drive.h"

namespace {
using namespace delio;
using namespace delio::slam_test;
using Eigen::Isometry3d;
using test::metresBetween;

/** S T S^-1. */
Poses conjugated(const Poses& poses, const Isometry3d& S) {
    Poses result;
    for (const auto& pose : poses) result.push_back(S * pose * S.inverse());
    return result;
}

TEST(Slam, GivesOnePoseForEachScanWithItsTime) {
    const auto truth = drive(6);
    const auto scans = scansOf(truth);
    Mapping mapping(withSkipEdges(1));
    for (const auto& scan : scans) {
        const auto report = mapping.slam.process(scan);
        EXPECT_EQ(mapping.slam.trajectory().stamps_s.back(), scan.stamp_s);
        EXPECT_FALSE(report.step.predicted);
    }
    const auto result = mapping.graph->optimise();
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.final_cost, result.initial_cost);
    EXPECT_EQ(mapping.poses()[0].matrix(), Isometry3d::Identity().matrix());
    ASSERT_EQ(mapping.slam.trajectory().stamps_s.size(), 6U);
    EXPECT_EQ(mapping.slam.trajectory().stamps_s[5], scans[5].stamp_s);
    const auto expected = test::fromFirst(truth);
    // Five increments one after the other.
    expectSame(mapping.slam.trajectory().poses, expected, 0.1, 0.6);
    expectSame(mapping.poses(), expected, 0.1, 0.6);
    EXPECT_EQ(mapping.map->builder().keyframes(), 2U);  // 2.5 m of path, one each 2 m
}

TEST(Slam, TakesNoScansOnceItIsClosed) {
    const auto scans = scansOf(drive(2));
    Mapping mapping(withSkipEdges(1));
    mapping.slam.process(scans[0]);
    mapping.slam.close();
    EXPECT_THROW(mapping.slam.process(scans[1]), Error);
    EXPECT_EQ(mapping.slam.trajectory().poses.size(), 1U);
}

// S T S^-1 of the sensor's trajectory T: the same scans, seen as another vehicle's.
TEST(Slam, TheTrajectoryIsTheVehicles) {
    const auto truth = drive(5);
    const auto ofSensor = run(scansOf(truth), withoutGraph());
    const auto ofVehicle = run(scansOf(truth, mounting()), withoutGraph());
    const auto &a = ofSensor.slam.trajectory().poses, &b = ofVehicle.slam.trajectory().poses;
    // The same numbers in another order: nothing but rounding between them.
    expectSame(b, conjugated(a, mounting()), 1e-9, 1e-5);
    EXPECT_GT(metresBetween(a[4], b[4]), 0.1);
}

// The optimum does not depend on whose frame the edges are written in. (Only nearly: an error of
// the vehicle's frame is not exactly one of the sensor's moved there by the adjoint.)
TEST(Slam, SoIsTheOptimisedOne) {
    const auto truth = drive(5);
    const auto ofSensor = run(scansOf(truth), withSkipEdges(2));
    const auto ofVehicle = run(scansOf(truth, mounting()), withSkipEdges(2));
    expectSame(ofVehicle.poses(), conjugated(ofSensor.poses(), mounting()), 1e-3, 1e-2);
}

// A small error e of the sensor's increment D is an error J e of the vehicle's S D S^-1; J by
// central differences.
TEST(Slam, CovariancesMoveFromTheSensorToTheVehicle) {
    const Isometry3d S = mounting();
    const auto truth = drive(3);
    const auto ofSensor = run(scansOf(truth), withSkipEdges(1));
    const auto ofVehicle = run(scansOf(truth, S), withSkipEdges(1));
    const auto& edges = ofVehicle.graph->graph().edges();
    ASSERT_EQ(edges.size(), 3U);
    ASSERT_EQ(ofSensor.graph->graph().edges().size(), 3U);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& before = ofSensor.graph->graph().edges()[i].increment;
        const Isometry3d Z = S * before.pose * S.inverse();
        Matrix6 J;
        const double h = 1e-6;
        for (int k = 0; k < 6; ++k) {
            const auto errorOf = [&](const Vector6& e) {
                return test::errorOf(Z, Isometry3d::Identity(),
                                     S * test::moved(before.pose, e) * S.inverse());
            };
            J.col(k) = (errorOf(h * Vector6::Unit(k)) - errorOf(-h * Vector6::Unit(k))) / (2 * h);
        }
        const Matrix6 expected = J * before.covariance * J.transpose();
        const Matrix6& found = edges[i].increment.covariance;
        // Skip edges start from poses that differ by rounding.
        constexpr double kSame = 1e-4;
        EXPECT_LT((found - expected).norm(), kSame * expected.norm()) << found << "\n\n"
                                                                      << expected;
        EXPECT_GT((found - before.covariance).norm(), 100 * kSame * expected.norm());
    }
}

TEST(Slam, WithoutTheGraphTheTrajectoryIsTheOdometrys) {
    Mapping mapping(withoutGraph());
    for (const auto& scan : scansOf(drive(4), mounting())) mapping.slam.process(scan);
    EXPECT_EQ(mapping.graph->graph().edges().size(), 3U);  // the chain
    ASSERT_EQ(mapping.poses().size(), 4U);
    expectSameBytes(mapping.poses(), mapping.slam.trajectory().poses);
    mapping.graph->optimise();
    expectSame(mapping.poses(), mapping.slam.trajectory().poses, 1e-9, 1e-6);
}

TEST(Slam, SkipEdgesAreAsManyAsTheOptionSays) {
    const auto scans = scansOf(drive(5));
    const std::size_t expected[] = {4, 4 + 3, 4 + 3 + 2, 4 + 3 + 2 + 1, 4 + 3 + 2 + 1};
    for (const unsigned skip : {1U, 9U}) {
        const auto mapping = run(scans, withSkipEdges(skip));
        const auto& graph = mapping.graph->graph();
        EXPECT_EQ(graph.edges().size(), expected[std::min(skip, 4U)]) << skip;
        for (std::size_t from = 0; from < 5; ++from)
            for (std::size_t to = from + 1; to < 5; ++to)
                EXPECT_EQ(isThere(graph, from, to), to - from <= skip + 1);
    }
}

TEST(Slam, EdgesEndWhereScansNoLongerOverlap) {
    auto options = withSkipEdges(9);
    options.graph.min_overlap = 1;
    EXPECT_EQ(run(scansOf(drive(5)), options).graph->graph().edges().size(), 4U);  // the chain
}

// What is known while driving is nearly what is known in the end.
TEST(Slam, TheWindowOptimisesWhileDriving) {
    const auto scans = scansOf(drive(8));
    const auto drivenBy = [&](unsigned window) {
        auto options = withSkipEdges(2);
        options.graph.window = window;
        Mapping mapping(options);
        for (const auto& scan : scans) mapping.slam.process(scan);
        const auto odometry = mapping.slam.trajectory().poses, live = mapping.poses();
        mapping.graph->optimise();
        double fromOdometry = 0, fromOptimum = 0;
        for (std::size_t i = 0; i < live.size(); ++i) {
            fromOdometry = std::max(fromOdometry, metresBetween(live[i], odometry[i]));
            fromOptimum = std::max(fromOptimum, metresBetween(live[i], mapping.poses()[i]));
        }
        return std::make_pair(fromOdometry, fromOptimum);
    };
    const auto [moved, left] = drivenBy(4);
    EXPECT_GT(moved, 1e-3);
    EXPECT_LT(left, moved / 3);
    EXPECT_EQ(drivenBy(0).first, 0);
}

TEST(Slam, AScanThatDidNotRegisterHasTheChainAlone) {
    auto scans = scansOf(drive(6));
    scans[3].points->clear();
    const auto mapping = run(scans, withSkipEdges(1));
    const auto& graph = mapping.graph->graph();
    EXPECT_EQ(graph.poses().size(), 6U);
    EXPECT_TRUE(isThere(graph, 2, 3));
    EXPECT_TRUE(isThere(graph, 3, 4));
    EXPECT_FALSE(isThere(graph, 1, 3));
    EXPECT_FALSE(isThere(graph, 3, 5));
    EXPECT_TRUE(isThere(graph, 2, 4));  // over the gap
    EXPECT_EQ(graph.edges().size(), 5U + 2U);
}

// Every profile, with what the graph asks of its covariances.
TEST(Slam, AScanThatIsThereTwiceIsFine) {
    auto scans = scansOf(drive(3), mounting());
    scans.insert(scans.begin() + 1, scans[0]);
    scans.insert(scans.begin() + 3, scans[2]);
    for (const auto& profile : Options::profileNames()) {
        Options options = Options::ofProfile(profile);
        options.paper.lineRegistration.search_radius = 0;  // that takes its time
        Mapping mapping(options);
        for (const auto& scan : scans) EXPECT_NO_THROW(mapping.slam.process(scan)) << profile;
        EXPECT_NO_THROW(mapping.graph->optimise()) << profile;
        EXPECT_EQ(mapping.poses().size(), 5U);
    }
}

TEST(Slam, NothingButEmptyScans) {
    auto scans = scansOf(drive(3), mounting());
    for (auto& scan : scans) scan.points->clear();
    for (const auto& profile : Options::profileNames()) {
        const auto mapping = run(scans, Options::ofProfile(profile));
        ASSERT_EQ(mapping.poses().size(), 3U);
        EXPECT_LT(mapping.poses()[2].translation().norm(), 1e-9);
    }
}

TEST(Slam, WithoutAHistoryItKeepsTheLastPose) {
    const auto scans = scansOf(drive(5), mounting());
    Slam whole(makeOdometry(withoutGraph())), last(makeOdometry(withoutGraph()), History::Last);
    for (const auto& scan : scans) {
        whole.process(scan);
        last.process(scan);
        ASSERT_EQ(last.trajectory().poses.size(), 1U);
        EXPECT_EQ(last.trajectory().poses[0].matrix(), whole.trajectory().poses.back().matrix());
        EXPECT_EQ(last.trajectory().stamps_s[0], scan.stamp_s);
    }
}

/** It reads no scan: what Slam lets through. */
class AnyScan : public Odometry {
 public:
    Step process(const Scan&) override { return {}; }
};

/** A metre a scan; the third one corrects the second. */
class Correcting : public Odometry {
 public:
    explicit Correcting(bool staysInPlace = false) : staysInPlace_(staysInPlace) {}

    Step process(const Scan&) override {
        Step step;
        if (scans_++ > 0) step.increment.pose.translation().x() = 1;
        const Eigen::Isometry3d back(Eigen::Translation3d(-3, 0, 1));
        if (scans_ == 3) step.corrected = {{1, back, false, staysInPlace_}};
        return step;
    }

 private:
    bool staysInPlace_;
    unsigned scans_ = 0;
};

/** Keeps where the latest scan's vehicle coordinates put a point of each scan. */
class PointKeeper : public SlamListener {
 public:
    const char* name() const override { return "keeper"; }
    void add(const SlamScan& scan) override {
        if (scan.fromOldPose) inVehicle.back() = *scan.fromOldPose * inVehicle.back();
        for (const auto& [node, pose] : scan.corrected) poses[node] = pose;
        poses.push_back(scan.pose);
        inVehicle.emplace_back(1, 2, 3);
    }
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Eigen::Vector3d> inVehicle;
};

TEST(Slam, WhatAScanSawStaysWhereOnlyItsStampIsCorrected) {
    constexpr double kExact_m = 1e-12;
    std::vector<Eigen::Vector3d> seen;
    for (const bool staysInPlace : {true, false}) {
        Slam slam(std::make_unique<Correcting>(staysInPlace));
        const auto keeper = std::make_shared<PointKeeper>();
        slam.attach(keeper);
        for (Scan scan : scansOf(drive(4))) {
            scan.sensorPose = test::poseAt(0.5, 0, 2, M_PI / 2);
            slam.process(scan);
        }
        seen.push_back(keeper->poses[1] * keeper->inVehicle[1]);
    }
    EXPECT_LT((seen[0] - Eigen::Vector3d(1, 3, 3)).norm(), kExact_m);
    EXPECT_LT((seen[1] - Eigen::Vector3d(1, 1, 4)).norm(), kExact_m);
}

TEST(Slam, CorrectedPosesReplaceThoseOfEarlierScans) {
    constexpr double kExact_m = 1e-12;
    Slam slam(std::make_unique<Correcting>()), last(std::make_unique<Correcting>(), History::Last);
    for (Scan scan : scansOf(drive(4))) {
        scan.sensorPose = test::poseAt(0.5, 0, 2, M_PI / 2);  // the vehicle's x is the sensor's -y
        slam.process(scan);
        last.process(scan);
    }
    // Increments lead on from where the scans were said to be.
    const std::vector<Eigen::Vector3d> expected = {{0, 0, 0}, {0, -1, 1}, {0, 2, 0}, {0, 3, 0}};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_LT((slam.trajectory().poses[i].translation() - expected[i]).norm(), kExact_m) << i;
    EXPECT_LT((last.trajectory().poses[0].translation() - expected[3]).norm(), kExact_m);
}

TEST(Slam, ACorrectedScanHasTheSensorPoseOfItsTime) {
    constexpr double kExact_m = 1e-12;
    Slam slam(std::make_unique<Correcting>());
    auto scans = scansOf(drive(4));
    scans[1].sensorPose = test::poseAt(0, 0, 1, 0);  // the sensor was a metre higher
    for (const Scan& scan : scans) slam.process(scan);
    const std::vector<Eigen::Vector3d> expected = {{0, 0, 0}, {-1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_LT((slam.trajectory().poses[i].translation() - expected[i]).norm(), kExact_m) << i;
}

std::string faultOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Slam, ScansThatContradictThemselvesAreRefused) {
    Scan good = scansOf(drive(1))[0];
    good.index = 7;
    struct Case {
        Scan scan;
        std::string fault;
    };
    std::vector<Case> bad(4, {good, ""});
    const std::string points = std::to_string(good.points->size());
    bad[0].scan.points = nullptr;
    bad[0].fault = "scan 7: points is null: give a points map, which may be empty";
    bad[1].scan.times_s.resize(3);
    bad[1].fault =
        "scan 7: times_s has 3 values for " + points + " points: give one for each point, or none";
    bad[2].scan.rings.resize(good.points->size() + 1);
    bad[2].fault = "scan 7: rings has " + std::to_string(good.points->size() + 1) + " values for " +
                   points + " points: give one for each point, or none";
    bad[3].scan.sensorPose.translation().x() = std::nan("");
    bad[3].fault = "scan 7: sensorPose is not finite";
    for (const Case& one : bad) {
        Slam slam(std::make_unique<AnyScan>());
        EXPECT_EQ(faultOf([&] { slam.process(one.scan); }), one.fault);
        for (const auto& profile : Options::profileNames())
            EXPECT_EQ(
                faultOf([&] { makeOdometry(Options::ofProfile(profile))->process(one.scan); }),
                one.fault)
                << profile;
        EXPECT_EQ(faultOf([&] { odometry::preprocess(one.scan, {}); }), one.fault);
    }
    good.rings.resize(good.points->size());
    good.times_s.resize(good.points->size());
    EXPECT_EQ(faultOf([&] { makeOdometry({})->process(good); }), "");
    good.points = mrpt::maps::CSimplePointsMap::Create();
    good.rings.clear();
    good.times_s.clear();
    EXPECT_EQ(faultOf([&] { makeOdometry({})->process(good); }), "");
}
}  // namespace
