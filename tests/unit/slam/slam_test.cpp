#include "delio/slam/slam.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "gauss_newton.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
using test::degreesBetween;
using test::Vector6d;

CPose3D mounting() { return CPose3D::FromXYZYawPitchRoll(1.5, -0.6, 1.9, 0.8, 0.1, -0.05); }

/** Where the sensor was. */
std::vector<CPose3D> drive(std::size_t count) {
    std::vector<CPose3D> poses{CPose3D::FromXYZYawPitchRoll(-3, 1, 0, 0.3, 0, 0)};
    while (poses.size() < count)
        poses.push_back(poses.back() +
                        CPose3D::FromXYZYawPitchRoll(0.5, 0.02, 0, -0.03, 0.002, 0.001));
    return poses;
}

std::vector<Scan> scansOf(const std::vector<CPose3D>& poses, const CPose3D& sensorPose) {
    std::vector<Scan> scans;
    for (const auto& pose : poses) {
        test::Noise noise(static_cast<std::uint32_t>(scans.size()));
        auto made = test::ringScan(test::yard(), pose, {24, 360, -24, 8, 0.01}, noise);
        scans.push_back(test::scanOf(made.points));
        scans.back().index = 10 * scans.size();
        scans.back().stamp_s = 0.1 * static_cast<double>(scans.size());
        scans.back().time = mrpt::Clock::fromDouble(1e9 + scans.back().stamp_s);
        scans.back().sensorPose = sensorPose;
    }
    return scans;
}

/** No search for the first pair: that takes its time, and half a metre is found without. */
Options withSkipEdges(unsigned count) {
    Options options;
    options.odometry.lineRegistration.search_radius = 0;
    options.graph.skip_edges = count;
    return options;
}

Slam run(const std::vector<Scan>& scans, const Options& options, bool withGraph) {
    Slam slam(options, withGraph, false, "velodyne");
    for (const auto& scan : scans) slam.process(scan);
    slam.optimise();
    return slam;
}

void expectSame(const std::vector<CPose3D>& a, const std::vector<CPose3D>& b, double metres,
                double degrees) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_LT(a[i].distanceTo(b[i]), metres) << i << ": " << a[i] << " and " << b[i];
        EXPECT_LT(degreesBetween(a[i], b[i]), degrees) << i << ": " << a[i] << " and " << b[i];
    }
}

bool isThere(const graph::PoseGraph& graph, std::size_t from, std::size_t to) {
    for (const auto& edge : graph.edges())
        if (edge.from == from && edge.to == to) return true;
    return false;
}

TEST(Slam, GivesOnePoseForEachScanWithItsTime) {
    const auto truth = drive(6);
    const auto scans = scansOf(truth, {});
    Slam slam(withSkipEdges(1), true, true, "velodyne");
    for (const auto& scan : scans) {
        const auto report = slam.process(scan);
        EXPECT_EQ(report.index, scan.index);
        EXPECT_EQ(report.stamp_s, scan.stamp_s);
        EXPECT_FALSE(report.odometry.predicted);
    }
    const auto result = slam.optimise();
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.final_cost, result.initial_cost);
    EXPECT_EQ(slam.trajectory().poses[0], CPose3D());
    ASSERT_EQ(slam.trajectory().stamps_s.size(), 6U);
    EXPECT_EQ(slam.trajectory().stamps_s[5], scans[5].stamp_s);
    std::vector<CPose3D> fromFirst;
    for (const auto& pose : truth) fromFirst.push_back(pose - truth[0]);
    expectSame(slam.odometry().poses, fromFirst, 0.1, 0.6);  // five increments one after the other
    expectSame(slam.trajectory().poses, fromFirst, 0.1, 0.6);
    EXPECT_EQ(slam.mapBuilder().keyScans(), 2U);  // 2.5 m of path, one each 2 m
}

// S T S^-1 of the sensor's trajectory T: the same scans, seen as another vehicle's.
TEST(Slam, TheTrajectoryIsTheVehicles) {
    const CPose3D S = mounting();
    const auto truth = drive(5);
    const auto ofSensor = run(scansOf(truth, {}), withSkipEdges(0), false);
    const auto ofVehicle = run(scansOf(truth, S), withSkipEdges(0), false);
    std::vector<CPose3D> conjugated;
    for (const auto& pose : ofSensor.odometry().poses) conjugated.push_back(S + pose + (-S));
    // The same numbers in another order: nothing but rounding between them.
    expectSame(ofVehicle.odometry().poses, conjugated, 1e-9, 1e-5);
    EXPECT_GT(ofSensor.odometry().poses[4].distanceTo(ofVehicle.odometry().poses[4]), 0.1);
}

// The optimum does not depend on whose frame the edges are written in. (Only nearly: an error of
// the vehicle's frame is not exactly one of the sensor's moved there by the adjoint.)
TEST(Slam, SoIsTheOptimisedOne) {
    const CPose3D S = mounting();
    const auto truth = drive(5);
    const auto ofSensor = run(scansOf(truth, {}), withSkipEdges(2), true);
    const auto ofVehicle = run(scansOf(truth, S), withSkipEdges(2), true);
    std::vector<CPose3D> conjugated;
    for (const auto& pose : ofSensor.trajectory().poses) conjugated.push_back(S + pose + (-S));
    expectSame(ofVehicle.trajectory().poses, conjugated, 1e-3, 1e-2);
}

// A small error e of the sensor's increment D is an error J e of the vehicle's S D S^-1; J by
// central differences.
TEST(Slam, CovariancesMoveFromTheSensorToTheVehicle) {
    const CPose3D S = mounting();
    const auto truth = drive(3);
    const auto ofSensor = run(scansOf(truth, {}), withSkipEdges(1), true);
    const auto ofVehicle = run(scansOf(truth, S), withSkipEdges(1), true);
    const auto& edges = ofVehicle.poseGraph().edges();
    ASSERT_EQ(edges.size(), 3U);
    ASSERT_EQ(ofSensor.poseGraph().edges().size(), 3U);
    const Eigen::Isometry3d mounted = test::isometryOf(S);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& before = ofSensor.poseGraph().edges()[i].increment;
        const Eigen::Isometry3d D = test::isometryOf(before.pose);
        const Eigen::Isometry3d Z = mounted * D * mounted.inverse();
        Eigen::Matrix<double, 6, 6> J;
        const double h = 1e-6;
        for (int k = 0; k < 6; ++k) {
            const auto errorOf = [&](const Vector6d& e) {
                return test::errorOf(Z, Eigen::Isometry3d::Identity(),
                                     mounted * test::moved(D, e) * mounted.inverse());
            };
            J.col(k) = (errorOf(h * Vector6d::Unit(k)) - errorOf(-h * Vector6d::Unit(k))) / (2 * h);
        }
        const Eigen::Matrix<double, 6, 6> expected =
            J * before.covariance.asEigen() * J.transpose();
        const Eigen::Matrix<double, 6, 6> found = edges[i].increment.covariance.asEigen();
        // Skip edges start from poses that differ by rounding.
        EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm()) << found << "\n\n" << expected;
        EXPECT_GT((found - before.covariance.asEigen()).norm(), 0.1 * expected.norm());
    }
}

TEST(Slam, WithoutTheGraphTheTrajectoryIsTheOdometrys) {
    const auto scans = scansOf(drive(4), mounting());
    const auto slam = run(scans, withSkipEdges(3), false);
    EXPECT_EQ(slam.poseGraph().edges().size(), 3U);  // the chain
    ASSERT_EQ(slam.trajectory().poses.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(slam.trajectory().poses[i], slam.odometry().poses[i]);
    EXPECT_EQ(slam.mapBuilder().keyScans(), 0U);
}

TEST(Slam, SkipEdgesAreAsManyAsTheOptionSays) {
    const auto scans = scansOf(drive(5), {});
    const std::size_t expected[] = {4, 4 + 3, 4 + 3 + 2, 4 + 3 + 2 + 1, 4 + 3 + 2 + 1};
    for (const unsigned skip : {1U, 9U}) {
        const auto slam = run(scans, withSkipEdges(skip), true);
        EXPECT_EQ(slam.poseGraph().edges().size(), expected[std::min(skip, 4U)]) << skip;
        for (std::size_t from = 0; from < 5; ++from)
            for (std::size_t to = from + 1; to < 5; ++to)
                EXPECT_EQ(isThere(slam.poseGraph(), from, to), to - from <= skip + 1);
    }
}

TEST(Slam, EdgesEndWhereScansNoLongerOverlap) {
    const auto scans = scansOf(drive(5), {});
    auto options = withSkipEdges(9);
    options.graph.min_overlap = 1;
    EXPECT_EQ(run(scans, options, true).poseGraph().edges().size(), 4U);  // the chain
}

// What is known while driving is nearly what is known in the end.
TEST(Slam, TheWindowOptimisesWhileDriving) {
    const auto scans = scansOf(drive(8), {});
    const auto drivenBy = [&](unsigned window) {
        auto options = withSkipEdges(2);
        options.graph.window = window;
        Slam slam(options, true, false, "velodyne");
        for (const auto& scan : scans) slam.process(scan);
        const auto odometry = slam.odometry().poses, live = slam.trajectory().poses;
        slam.optimise();
        double fromOdometry = 0, fromOptimum = 0;
        for (std::size_t i = 0; i < live.size(); ++i) {
            fromOdometry = std::max(fromOdometry, live[i].distanceTo(odometry[i]));
            fromOptimum = std::max(fromOptimum, live[i].distanceTo(slam.trajectory().poses[i]));
        }
        return std::make_pair(fromOdometry, fromOptimum);
    };
    const auto [moved, left] = drivenBy(4);
    EXPECT_GT(moved, 1e-3);
    EXPECT_LT(left, moved / 3);
    EXPECT_EQ(drivenBy(0).first, 0);
}

TEST(Slam, AScanThatDidNotRegisterHasTheChainAlone) {
    auto scans = scansOf(drive(6), {});
    scans[3].points->clear();
    const auto slam = run(scans, withSkipEdges(1), true);
    const auto& graph = slam.poseGraph();
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
        options.odometry.lineRegistration.search_radius = 0;  // that takes its time
        Slam slam(options, true, true, "velodyne");
        for (const auto& scan : scans) EXPECT_NO_THROW(slam.process(scan)) << profile;
        EXPECT_NO_THROW(slam.optimise()) << profile;
        EXPECT_EQ(slam.trajectory().poses.size(), 5U);
    }
}

TEST(Slam, NothingButEmptyScans) {
    auto scans = scansOf(drive(3), mounting());
    for (auto& scan : scans) scan.points->clear();
    const auto slam = run(scans, {}, true);
    ASSERT_EQ(slam.trajectory().poses.size(), 3U);
    EXPECT_LT(slam.trajectory().poses[2].norm(), 1e-9);
}
}  // namespace
