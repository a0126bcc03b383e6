#pragma once
#include <vector>

#include "delio/graph/pose_graph.h"
#include "delio/places/localisation.h"
#include "delio/places/loops.h"
#include "delio/places/stored_map.h"

namespace delio {
/** A drive's pose graph in a map's frame: `graph` (one node per scan) with an additional edge from
 *  node 0 for each scan registered to the map. These nodes are at their measured poses; the
 *  odometry gives the others. Throws Error if no scan was localised in the map. */
graph::PoseGraph anchored(const graph::PoseGraph& graph, const std::vector<MapFix>& fixes);

/** Two maps that were joined. */
struct JoinedMap {
    MapContent content;  //!< refers to both maps; nothing where they could not be joined
    std::vector<places::LoopCandidate> joints;  //!< what was compared; nodes of the joined graph
    std::size_t accepted = 0;                   //!< of these: edges between the maps
    std::size_t added = 0;                      //!< submaps that the old map did not have
};

/** Adds a drive to a map in which it was localised: edges between the two are found by registration
 *  of their submaps, verified as loops are, and the graph of both is optimised. Submaps of what the
 *  map has already are left out. `drive`: its poses in the map's frame; `fixes`: of its nodes. */
JoinedMap joined(const StoredMap& map, const MapContent& drive, const std::vector<MapFix>& fixes,
                 const places::LoopOptions& loops, const places::ClosureOptions& closures,
                 const graph::PoseGraphOptions& optimisation);
}  // namespace delio
