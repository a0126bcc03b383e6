#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/loops/loop_search.h"

namespace delio::loops {
/** A drive whose loops were closed. */
struct ClosedLoops {
    graph::PoseGraph graph;                  //!< optimised; the loops' edges are its last ones
    graph::OptimisationResult optimisation;  //!< of the last time
    std::vector<LoopCandidate> candidates;   //!< of the last search
    std::size_t accepted = 0;                //!< of these: so many edges that are new
    /** Of the drift that LoopOptions expect, so much do the loops show (standard deviations); 0:
     *  none that the odometry's own covariances do not explain. The chain's edges in `graph` have
     *  that added: along their path, since what drifts goes one way and is no noise of scans. */
    double drift_factor = 0;
    double optimise_ms = 0;  //!< of the graph alone
};

/** Optimises a graph with the loops that were found, and searches once more where that moved a pose
 *  by more than 5 m. `graph`: the odometry's, with its poses; `search`: has the drive's submaps.
 *  Without a loop the graph is returned as it was given. */
ClosedLoops closeLoops(const graph::PoseGraph& graph, LoopSearch& search,
                       const graph::PoseGraphOptions& optimisation);
}  // namespace delio::loops
