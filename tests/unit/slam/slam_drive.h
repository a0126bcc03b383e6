#pragma once
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "delio/odometry/odometry.h"
#include "delio/slam/listeners.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"
#include "poses.h"
#include "ring_scan.h"

/** What the tests of Slam and of its listeners share. */
namespace delio::slam_test {
using Poses = std::vector<Eigen::Isometry3d>;

inline Eigen::Isometry3d mounting() { return test::poseAt(1.5, -0.6, 1.9, 0.8, 0.1, -0.05); }

/** Where the sensor was. */
inline Poses drive(std::size_t count) {
    Poses poses{test::poseAt(-3, 1, 0, 0.3)};
    while (poses.size() < count)
        poses.push_back(poses.back() * test::poseAt(0.5, 0.02, 0, -0.03, 0.002, 0.001));
    return poses;
}

inline std::vector<Scan> scansOf(
    const Poses& poses, const Eigen::Isometry3d& sensorPose = Eigen::Isometry3d::Identity()) {
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

/** The paper's odometry, which can make them. No search for the first pair: that takes its time,
 *  and half a metre is found without. */
inline Options withSkipEdges(unsigned count) {
    Options options = Options::ofProfile("paper");
    options.paper.lineRegistration.search_radius = 0;
    options.graph.skip_edges = count;
    return options;
}

/** The bare chain. */
inline Options withoutGraph() {
    Options options = withSkipEdges(0);
    options.graph.window = 0;
    return options;
}

/** Slam with the listeners that a program gives it. */
struct Mapping {
    explicit Mapping(const Options& options) : Mapping(options, makeOdometry(options)) {}
    /** @param first, between, last further listeners: before, between and after graph and map */
    Mapping(const Options& options, std::unique_ptr<Odometry> odometry,
            const std::shared_ptr<SlamListener>& first = {},
            const std::shared_ptr<SlamListener>& between = {},
            const std::shared_ptr<SlamListener>& last = {})
        : slam(std::move(odometry)),
          graph(std::make_shared<GraphBuilder>(options.graph)),
          map(std::make_shared<MapListener>(map::MapBuilder(options.map, "velodyne"))) {
        for (const auto& listener :
             std::vector<std::shared_ptr<SlamListener>>{first, graph, between, map, last})
            if (listener) slam.attach(listener);
    }

    const Poses& poses() const { return graph->graph().poses(); }

    Slam slam;
    std::shared_ptr<GraphBuilder> graph;
    std::shared_ptr<MapListener> map;
};

/** All scans, and the whole graph optimised in the end. */
inline Mapping run(const std::vector<Scan>& scans, const Options& options) {
    Mapping mapping(options);
    for (const auto& scan : scans) mapping.slam.process(scan);
    mapping.graph->optimise();
    return mapping;
}

inline void expectSame(const Poses& a, const Poses& b, double metres, double degrees) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_LT(test::metresBetween(a[i], b[i]), metres) << i << ":\n"
                                                           << a[i].matrix() << "\nand\n"
                                                           << b[i].matrix();
        EXPECT_LT(test::degreesBetween(a[i], b[i]), degrees) << i << ":\n"
                                                             << a[i].matrix() << "\nand\n"
                                                             << b[i].matrix();
    }
}

inline void expectSameBytes(const Poses& a, const Poses& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].matrix(), b[i].matrix()) << i;
}

/** Poses, edges and their weights. */
inline void expectSameBytes(const graph::PoseGraph& a, const graph::PoseGraph& b) {
    expectSameBytes(a.poses(), b.poses());
    ASSERT_EQ(a.edges().size(), b.edges().size());
    for (std::size_t i = 0; i < a.edges().size(); ++i) {
        const auto &left = a.edges()[i], &right = b.edges()[i];
        EXPECT_EQ(left.from, right.from) << i;
        EXPECT_EQ(left.to, right.to) << i;
        EXPECT_EQ(left.increment.pose.matrix(), right.increment.pose.matrix()) << i;
        EXPECT_EQ(left.increment.covariance, right.increment.covariance) << i;
        EXPECT_EQ(a.information(i), b.information(i)) << i;
    }
}

inline bool isThere(const graph::PoseGraph& graph, std::size_t from, std::size_t to) {
    for (const auto& edge : graph.edges())
        if (edge.from == from && edge.to == to) return true;
    return false;
}
}  // namespace delio::slam_test
