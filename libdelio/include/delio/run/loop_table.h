#pragma once
#include <string>
#include <vector>

#include "delio/loops/loop_search.h"

namespace delio::run {
/** Writes loops.csv: a row for each pair of places that was compared, with the nodes of the pose
 *  graph, what was searched and found, and why it was refused (empty: it was accepted). Error where
 *  the file cannot be written. */
void writeLoopTable(const std::vector<loops::LoopCandidate>& candidates, const std::string& path);

/** What a reader of loops.csv wants to know of a pair. */
struct LoopRow {
    std::size_t fromNode = 0;  //!< of the pose graph, the earlier
    std::size_t toNode = 0;    //!< the later
    bool accepted = false;     //!< both are one place
    std::string reason;        //!< why it was not
};

/** Throws Error with file and line where a column is missing or malformed. */
std::vector<LoopRow> readLoopTable(const std::string& path);
}  // namespace delio::run
