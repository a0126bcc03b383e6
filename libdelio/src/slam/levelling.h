#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/odometry/imu.h"
#include "slam/specific_force.h"

namespace delio {
/** A drive, and what its accelerometer measured. */
struct ForcesOnTrack {
    std::vector<double> stamps_s;  //!< of the poses
    std::vector<bool> usable;      //!< false for a pose that was only predicted
    /** IMU to vehicle, at each pose. */
    std::vector<Eigen::Matrix3d> mounts;
    std::vector<std::optional<ForceBetween>> forces;  //!< from pose i to pose i+1
};

/** A levelled pose graph. */
struct Levelled {
    Vertical vertical;
    graph::PoseGraph graph;  //!< with the poses tilted by the vertical
};

/** Finds the vertical in the map's frame and the accelerometer's bias from stretches of four
 *  seconds: the force, integrated twice along the poses, less the way, leaves half the square of
 *  time times gravity. With `options`, each stretch holds the tilt of its middle pose in the graph,
 *  as closely as successive stretches agree; the first pose stays where it is. */
Levelled levelled(const graph::PoseGraph& graph, const ForcesOnTrack& track,
                  const graph::PoseGraphOptions* options);
}  // namespace delio
