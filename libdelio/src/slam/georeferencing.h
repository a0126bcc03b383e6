#pragma once
#include "delio/earth/georeference.h"
#include "delio/graph/pose_graph.h"
#include "earth/track.h"

namespace delio {
/** A georeferenced pose graph. */
struct Georeferenced {
    earth::Georeference place;
    earth::GnssFigures figures;  //!< with the reason where it is not georeferenced
    graph::PoseGraph graph;      //!< with the poses moved by the fixes
};

/** Georeferences a drive by its fixes: one rigid transformation, and with `options` each fix as a
 *  factor of the pose graph, where outliers are left out. Its poses are those of `track`, of which
 *  the first stays where it is. */
Georeferenced georeferenced(const graph::PoseGraph& graph, const earth::Track& track,
                            const earth::Fixes& fixes, const graph::PoseGraphOptions* options);
}  // namespace delio
