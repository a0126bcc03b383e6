#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delio/places/stored_map.h"

namespace delio {
/** An edge of a stored map's graph between two submaps: a loop, or a joint of two drives. */
struct SubmapEdge {
    std::size_t from = 0;  //!< submap
    std::size_t to = 0;    //!< submap
    graph::Edge edge;      //!< between their key nodes
    double off_m = 0;      //!< between where the edge has `to` and where the graph has it
    double off_deg = 0;    //!< the same of the rotation
};

/** In the order of the graph's edges. */
std::vector<SubmapEdge> submapEdges(const StoredMap& map);

/** Writes them as a CSV with a header line. Error if that fails. */
void saveSubmapEdges(const std::vector<SubmapEdge>& edges, const std::string& path);

/** A change of the graph by hand. */
struct GraphEdit {
    /** What is changed. */
    enum class Kind {
        Add,    //!< an edge, where registration and the acceptance tests for loops confirm it
        Forbid  //!< removes all edges between the two
    };
    Kind kind = Kind::Add;  //!< what is changed
    std::size_t from = 0;   //!< submap
    std::size_t to = 0;     //!< submap
};

/** Reads lines `add 3 17` and `forbid 2 9`; # begins a comment. Error, which names file and line,
 *  for anything else. */
std::vector<GraphEdit> readGraphEdits(const std::string& path);

/** The map with a changed graph, optimised after each edit; refers to `map`. The same edits give
 *  the same map. Error, which names the edit, for submaps that the map does not have, an edge that
 *  is not accepted (with the reason), and an edge to forbid that is not there. */
MapContent edited(const StoredMap& map, const std::vector<GraphEdit>& edits);
}  // namespace delio
