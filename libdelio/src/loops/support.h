#pragma once
#include <vector>

#include "delio/loops/loop_search.h"

namespace delio::loops {
/** Names a reason in those candidates that were registered but cannot be believed: they lead
 *  farther than the chain of poses may have drifted, or contradict others that agree among
 *  themselves (pairwise consistency, Mangelsohn et al. 2018), or no neighbour says the same.
 *  `level`: the submaps' level frames where the odometry alone puts them: poses that a wrong loop
 *  has bent would confirm it. */
void refuseUnsupported(std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                       const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options);
}  // namespace delio::loops
