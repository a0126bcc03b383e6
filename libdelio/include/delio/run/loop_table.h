#pragma once
#include <string>
#include <vector>

#include "delio/loops/loop_search.h"

namespace delio::run {
/** Writes loops.csv: a row for each pair of places that was compared, with the nodes of the pose
 *  graph, what was searched and found, and why it was refused (empty: it was accepted). Error where
 *  the file cannot be written. */
void writeLoopTable(const std::vector<loops::LoopCandidate>& candidates, const std::string& path);
}  // namespace delio::run
