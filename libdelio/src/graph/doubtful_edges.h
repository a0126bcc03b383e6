#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"

namespace delio::graph {
/** Which edges contradict the chain (i,i+1) of a drive: those whose error, at the graph's poses, is
 *  beyond `width` standard deviations of what the edge and the chain between its nodes may be off
 *  together. A loop closed after 10 m of drift does not, where the chain says that it drifts so
 *  much. Where two or more short edges contradict one step of the chain and none agrees with it, it
 *  is that step which is doubtful, not they. Nothing is doubted across steps that the chain does
 * not have, or whose own edge contradicts the poses. An entry for each of `graph.edges()`. */
std::vector<bool> doubtfulEdges(const PoseGraph& graph, double width);
}  // namespace delio::graph
