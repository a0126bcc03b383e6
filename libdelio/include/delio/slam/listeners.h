#pragma once
#include <deque>
#include <memory>

#include "delio/graph/pose_graph.h"
#include "delio/map/map_builder.h"
#include "delio/slam/slam.h"

namespace delio {
/** Builds the pose graph of a drive (section V): the chain of increments, edges to scans before the
 *  last one where the odometry can make them, and while driving its last nodes optimised. */
class GraphBuilder : public SlamListener {
 public:
    /** Of an empty graph. */
    explicit GraphBuilder(const graph::PoseGraphOptions& options) : options_(options) {}

    const char* name() const override { return "graph"; }
    void add(const SlamScan& scan) override;

    /** Optimises the whole graph; while driving, its last nodes were. */
    graph::OptimisationResult optimise() { return graph_.optimise(options_); }

    const graph::PoseGraph& graph() const { return graph_; }  //!< one node per scan

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

/** Puts the points of a drive into a map, without those of dynamic objects. Scans that could not be
 *  registered are ignored, because their poses are only predicted. The map's lengths follow the
 *  size of the place ("scale" among the step's details) at the first scan. */
class MapListener : public SlamListener {
 public:
    /** `builder`: empty. */
    explicit MapListener(map::MapBuilder builder) : builder_(std::move(builder)) {}

    const char* name() const override { return "map"; }
    void add(const SlamScan& scan) override;

    const map::MapBuilder& builder() const { return builder_; }  //!< with what was added so far

 private:
    map::MapBuilder builder_;
};
}  // namespace delio
