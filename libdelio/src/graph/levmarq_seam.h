#pragma once
#include <mrpt/graphs/CNetworkOfPoses.h>

#include "delio/graph/pose_graph.h"

namespace delio::graph {
/** What MRPT's Levenberg-Marquardt is given. Not the CNetworkOfPoses3DInf that MRPT's binaries
 *  hold: for this type the errors, their Jacobians and the cost are ours (levmarq_seam.cpp), where
 *  MRPT's own would accept steps by the sum of squares without the information, and swap yaw and
 *  roll. An edge's `cov_inv` holds no information here but its root U, U' U = Omega. */
struct WhitenedGraph : mrpt::graphs::CNetworkOfPoses<mrpt::poses::CPose3DPDFGaussianInf,
                                                     mrpt::containers::map_traits_map_as_vector> {
    double kernelWidth = 0;
};

/** Minimises over all nodes but `graph.root`; final poses are in `graph.nodes`. */
OptimisationResult minimise(WhitenedGraph& graph, unsigned maxIterations);
}  // namespace delio::graph
