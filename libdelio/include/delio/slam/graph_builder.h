#pragma once
#include <deque>
#include <memory>
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/slam/listener.h"

namespace delio {
/** Makes the pose graph of a drive (section V): the chain of increments, edges to scans before the
 *  last one where the odometry can make them, and while driving its last nodes optimised. */
class GraphBuilder : public SlamListener {
 public:
    /** Of an empty graph. */
    explicit GraphBuilder(const graph::PoseGraphOptions& options) : options_(options) {}

    const char* name() const override { return "graph"; }
    void add(const SlamScan& scan) override;

    /** Optimises the whole graph; while driving, its last nodes were. */
    graph::OptimisationResult optimise() { return graph_.optimise(options_); }

    const graph::PoseGraph& graph() const { return graph_; }  //!< a node a scan

 private:
    struct Recent {
        std::size_t node = 0;
        std::shared_ptr<const ScanFeatures> features;
        Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();
    };
    void addSkipEdges(const Recent& latest);

    graph::PoseGraphOptions options_;
    graph::PoseGraph graph_;
    std::deque<Recent> recent_;  //!< scans that edges may still be made to, latest first
};
}  // namespace delio
