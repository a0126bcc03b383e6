#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/loops/loop_search.h"

namespace delio::loops {
/** A drive whose loops were closed. */
struct ClosedLoops {
    graph::PoseGraph graph;  //!< optimised; the loops' edges are its last ones
    graph::OptimisationResult optimisation;
    std::vector<LoopCandidate> candidates;  //!< of the last search
    std::size_t accepted = 0;               //!< of these: so many edges
    /** By which the odometry's standard deviations were too small, as the loops show; 1 at least.
     *  Its edges in the graph have it: drift goes one way, and adds up faster than noise. */
    double drift_factor = 1;
};

/** Searches for loops, optimises the graph with them, and searches once more where that moved a
 *  pose by more than 5 m. `graph`: the odometry's, with its poses. Without a loop it is returned as
 *  it was given. */
ClosedLoops closeLoops(const graph::PoseGraph& graph, const std::vector<Submap>& submaps,
                       const LoopOptions& options, const ClosureOptions& closure,
                       const graph::PoseGraphOptions& optimisation);
}  // namespace delio::loops
