#pragma once
#include "delio/localisation/stored_map.h"
#include "delio/map/map_builder.h"

namespace delio::run {
/** The maps that a run made; null: none. */
struct RunMaps {
    const map::MapBuilder* points = nullptr;  //!< of map.ply and all that is drawn
    const MapContent* stored = nullptr;       //!< to come back to
    bool keepDynamic = false;  //!< what is taken out of `points` has a file of its own
};
}  // namespace delio::run
