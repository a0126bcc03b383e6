#pragma once
#include <vector>

#include "delio/localisation/anchored_graph.h"
#include "delio/localisation/stored_map.h"
#include "delio/loops/loop_search.h"

namespace delio {
/** Two maps that became one. */
struct JoinedMap {
    MapContent content;  //!< refers to both maps; nothing where they could not be joined
    std::vector<loops::LoopCandidate> joints;  //!< what was compared; nodes of the joined graph
    std::size_t accepted = 0;                  //!< of these: edges between the maps
    std::size_t added = 0;                     //!< submaps that the old map did not have
};

/** Adds a drive to a map in which it was localised: edges between the two are found by registration
 *  of their submaps, verified as loops are, and the graph of both is optimised. Submaps of what the
 *  map has already are left out. `drive`: its poses in the map's frame; `fixes`: of its nodes. */
JoinedMap joined(const StoredMap& map, const MapContent& drive, const std::vector<MapFix>& fixes,
                 const loops::LoopOptions& loops, const loops::ClosureOptions& closures,
                 const graph::PoseGraphOptions& optimisation);
}  // namespace delio
