#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/localisation/map_tracker.h"

namespace delio {
/** A drive's pose graph in a map's frame: `graph` (a node a scan) with an edge more for each scan
 *  that was measured there. Its nodes lie where they were measured, the others where the odometry
 *  puts them from there. Node 0 stays: it is the reference of those edges. Error where no scan was
 *  found in the map. */
graph::PoseGraph anchored(const graph::PoseGraph& graph, const std::vector<MapFix>& fixes);

/** True where the scan's place in the map can be relied on. */
bool isAnchor(const MapFix& fix);
}  // namespace delio
