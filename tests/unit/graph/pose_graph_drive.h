#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/graph/pose_graph.h"
#include "poses.h"

/** What the tests of the pose graph share. */
namespace delio::pose_graph_test {
using graph::PoseGraph;
using test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

inline graph::PoseGraphOptions withKernel(double width) {
    graph::PoseGraphOptions options;
    options.kernel_width = width;
    return options;
}

inline graph::Edge edgeOf(std::size_t from, std::size_t to, const Eigen::Isometry3d& measured,
                          const std::vector<double>& variances) {
    graph::Edge edge{from, to, {measured, Matrix6::Zero()}};
    for (int i = 0; i < 6; ++i)
        edge.increment.covariance(i, i) = variances[static_cast<std::size_t>(i)];
    return edge;
}

/** Numbers that are the same wherever the test runs, which std's distributions are not. */
class PoseNoise {
 public:
    double operator()() { return static_cast<double>(engine_()) / 2147483648.0 - 1; }  // [-1, 1)
    Eigen::Isometry3d pose(double metres, double radians) {
        const double x = metres * (*this)(), y = metres * (*this)(), z = metres * (*this)();
        const double a = radians * (*this)(), b = radians * (*this)(), c = radians * (*this)();
        return poseAt(x, y, z, a, b, c);
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
inline PoseGraph drive(std::size_t n) {
    PoseNoise noise;
    Poses truth{Eigen::Isometry3d::Identity()};
    while (truth.size() < n) truth.push_back(truth.back() * poseAt(0.9, 0, 0, 0.01, 0, 0));
    const auto measured = [&](std::size_t i, std::size_t j) {
        return truth[i].inverse() * truth[j] * noise.pose(0.02, 0.001);
    };
    const std::vector<double> variances{1e-4, 1e-4, 1e-4, 3e-7, 3e-7, 3e-7};
    PoseGraph graph;
    graph.addNode(truth[0]);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const Eigen::Isometry3d step = measured(i, i + 1);
        graph.addNode(graph.poses()[i] * step);
        graph.addEdge(edgeOf(i, i + 1, step, variances));
    }
    for (std::size_t i = 0; i + 2 < n; ++i)
        graph.addEdge(edgeOf(i, i + 2, measured(i, i + 2), variances));
    return graph;
}

inline double largestDistance(const Poses& a, const Poses& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, test::metresBetween(a[i], b[i]));
    return largest;
}

inline void expectSame(const Poses& a, const Poses& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].matrix(), b[i].matrix()) << i;
}

inline std::string faultOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}
}  // namespace delio::pose_graph_test
