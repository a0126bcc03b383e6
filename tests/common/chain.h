#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"

namespace delio::test {
/** The pose graph of an odometry: a node a pose, and the steps between; standard deviations of
 *  each. */
inline graph::PoseGraph chainOf(const std::vector<Eigen::Isometry3d>& poses, double sigma_m = 1e-3,
                                double sigma_rad = 1e-4) {
    graph::PoseGraph graph;
    for (const auto& pose : poses) graph.addNode(pose);
    for (std::size_t i = 1; i < poses.size(); ++i) {
        Increment step{poses[i - 1].inverse() * poses[i], Matrix6::Identity()};
        step.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
            Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
        graph.addEdge({i - 1, i, step});
    }
    return graph;
}
}  // namespace delio::test
