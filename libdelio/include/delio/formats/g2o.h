#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "delio/graph/pose_graph.h"

namespace delio::io {
/** Reads a g2o file of VERTEX_SE3:QUAT, EDGE_SE3:QUAT and FIX lines, in any order; empty lines and
 *  lines that start with '#' are skipped. Vertices become nodes 0, 1, 2 ... in the order of their
 *  ids. g2o's information speaks of the quaternion's vector part, half the angle: it is brought to
 *  radians here, and back when saving. Throws Error with file and line for anything else: a missing
 *  file, an unknown tag, a line that is short, long or holds a number that is not finite, a
 *  quaternion off unit length by more than 1e-3, an information matrix that is not positive
 *  definite, a vertex given twice, an edge to a missing vertex, a last line without its end (a file
 *  that was cut off), a FIX of any other vertex than the first, no vertex at all. */
graph::PoseGraph loadG2o(const std::string& path);

/** Writes the same, node 0 fixed, with the digits that give the same doubles back. Vertices are
 *  numbered from 0 whatever ids they were loaded with. A saved file that is loaded and saved
 *  again has the same bytes. */
void saveG2o(const graph::PoseGraph& graph, const std::string& path);

/** Writes the graph as mrpt::graphs::CNetworkOfPoses3DInf does (VERTEX3 and EDGE3 lines, angles
 *  in place of quaternions, information about them), with 17 digits. Its loadFromTextFile reads
 *  it, though MRPT 2.5.8's takes the information that links two angles for zero. `loops`: pairs of
 *  nodes whose edges close loops, marked by lines "# loop FROM TO" at the end, which MRPT passes
 *  over. */
void saveMrptText(const graph::PoseGraph& graph, const std::string& path,
                  const std::vector<std::pair<std::size_t, std::size_t>>& loops = {});
}  // namespace delio::io
