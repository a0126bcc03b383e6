#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "delio/places/stored_map.h"

namespace delio {
/** A drive that was localised in a map. All in the map's frame, metres. */
struct VisitScans {
    Visit visit;
    std::vector<Eigen::Isometry3d> poses;  //!< of the vehicle, where it was measured in the map
    Eigen::Matrix3Xf points;               //!< labelled as static
    /** For each of these points 1 where the scans saw through it, otherwise 0. */
    std::function<std::vector<std::uint8_t>(const Eigen::Matrix3Xf&)> seenThrough;
};

/** A map after a visit. */
struct UpdatedMap {
    MapContent content;  //!< refers to the old map
    UpdateFigures figures;
};

/** Adds a visit to the history of a map's points: those that it saw, those that it saw through, and
 *  new ones. See share/doc/stored_map.md. Throws Error where the map has a later visit, or this
 *  one. */
UpdatedMap updated(const StoredMap& map, const VisitScans& scans);
}  // namespace delio
