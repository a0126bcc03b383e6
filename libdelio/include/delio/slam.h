#pragma once
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/io/trajectory.h"
#include "delio/map/map_builder.h"
#include "delio/odometry.h"
#include "delio/profile.h"

namespace delio {
/** What became of one scan. */
struct ScanReport {
    std::size_t index = 0;  //!< of the scan in its rawlog
    double stamp_s = 0;
    OdometryResult odometry;
    double graph_ms = 0;  //!< for the edges to scans before the last one, and the window
    double map_ms = 0;    //!< for its points in the map
};

/** Odometry, pose graph and map: scans in, optimised trajectory and map out. Poses are the
 *  vehicle's: they map its coordinates to those it had at the first scan. */
class Slam {
 public:
    /** Without `withGraph` the final trajectory is the odometry's; without `withMap` no points are
     *  kept and memory grows by the poses alone. `folder`: see MapBuilder. */
    Slam(const Options& options, bool withGraph, bool withMap, const std::string& sensorLabel,
         const std::string& folder = "");

    ScanReport process(const Scan& scan);

    /** Optimises the whole pose graph (section V); while driving, its last nodes were. */
    graph::OptimisationResult optimise();

    const io::Trajectory& odometry() const { return odometryTrajectory_; }
    /** After optimise(): the final poses, with their times. Before: the best at that moment. */
    io::Trajectory trajectory() const;
    const graph::PoseGraph& poseGraph() const { return graph_; }
    const map::MapBuilder& mapBuilder() const { return map_; }

 private:
    struct Recent {
        std::size_t node = 0;
        std::shared_ptr<const Features> features;
        mrpt::poses::CPose3D sensorPose;
    };
    void addSkipEdges(const Recent& latest);

    Options options_;
    bool withGraph_, withMap_;
    Odometry odometry_;
    graph::PoseGraph graph_;
    map::MapBuilder map_;
    io::Trajectory odometryTrajectory_;
    std::deque<Recent> recent_;  //!< scans that edges may still be made to, latest first
};
}  // namespace delio
