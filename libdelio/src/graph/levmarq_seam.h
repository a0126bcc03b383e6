#pragma once
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <set>

#include "delio/graph/pose_graph.h"

namespace delio::graph {
/** What MRPT's Levenberg-Marquardt is given. Not the CNetworkOfPoses3DInf that MRPT's binaries
 *  hold: for this type the errors, their Jacobians and the cost are ours (levmarq_seam.cpp), where
 *  MRPT's own would accept steps by the sum of squares without the information, and swap yaw and
 *  roll. An edge's `cov_inv` holds no information here but its root U, U' U = Omega. */
struct WhitenedGraph : mrpt::graphs::CNetworkOfPoses<mrpt::poses::CPose3DPDFGaussianInf,
                                                     mrpt::containers::map_traits_map_as_vector> {
    using MapEntry = edges_map_t::value_type;

    /** Node of the pose graph that is number 0 here: its container has room for each number up to
     *  the largest. */
    std::size_t firstNode = 0;
    double kernelWidth = 0;                //!< of the Geman-McClure kernel; 0: none
    double doubtfulWidth = 0;              //!< the same for the edges in `doubtful`
    std::set<const MapEntry*> doubtful;    //!< entries of `edges`
    std::set<mrpt::graphs::TNodeID> free;  //!< nodes that are moved; the others stay

    double widthOf(const MapEntry& edge) const {
        return doubtful.count(&edge) > 0 ? doubtfulWidth : kernelWidth;
    }
};

/** Minimises over the free nodes; final poses are in `graph.nodes`. */
OptimisationResult minimise(WhitenedGraph& graph, unsigned maxIterations);

/** Squared errors under the kernel, summed over all edges. */
double costOf(const WhitenedGraph& graph);

/** The largest error of an edge that is not doubtful, in standard deviations. */
double largestError(const WhitenedGraph& graph);
}  // namespace delio::graph
