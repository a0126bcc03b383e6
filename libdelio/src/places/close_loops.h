#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"
#include "places/loop_search.h"

namespace delio::places {
/** A drive whose loops were closed. */
struct ClosedLoops {
    graph::PoseGraph graph;                  //!< optimised; the loops' edges are its last ones
    graph::OptimisationResult optimisation;  //!< of the last time
    std::vector<LoopCandidate> candidates;   //!< of the last search
    std::size_t accepted = 0;                //!< new edges
    /** Drift that the loops show, as a multiple of what LoopOptions expect (standard deviations).
     * 0: the odometry's own covariances explain them. The covariances of the chain's edges in
     * `graph` have that drift added, in proportion to the path. */
    double drift_factor = 0;
    double optimise_ms = 0;  //!< of the graph alone
};

/** Optimises a graph with the loops that were found, and searches again if that moved a pose by
 * more than 5 m. `graph`: the odometry's, with its poses. `search`: has the drive's submaps.
 * Without a loop the graph is returned as it was. */
ClosedLoops closeLoops(const graph::PoseGraph& graph, LoopSearch& search,
                       const graph::PoseGraphOptions& optimisation);

/** The graph with one more edge. Where the chain contradicts it, the covariances of the chain get
 *  as much drift, in proportion to the path, as makes the edge likely. Not optimised. */
graph::PoseGraph closedBy(const graph::PoseGraph& graph, const graph::Edge& loop,
                          const LoopOptions& options);

/** Refuses candidates that were registered but are not consistent: farther off than the odometry
 * may have drifted, in contradiction to others that agree among themselves (pairwise consistency,
 *  Mangelsohn et al. 2018), or without a neighbour that agrees. `level`: the submaps' level frames
 * by the odometry alone, as poses that a wrong loop has bent would confirm it. */
void refuseInconsistent(std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                        const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options);
}  // namespace delio::places
