#pragma once
#include <string>
#include <vector>

#include "delio/map/colouring.h"
#include "delio/map/occupancy.h"
#include "map_input.h"

namespace delio {
/** How a map is written. */
struct MapOutputOptions {
    map::Colouring colouring;
    map::OccupancyOptions grid;
};

/** A kind of file that a map is written as. */
struct MapOutput {
    const char* extension;
    bool isGrid;  //!< and not of points, which have colours
    void (*write)(const MapInput& map, const std::string& path, const MapOutputOptions& options);
};

/** All of them: another kind is a row more. */
const std::vector<MapOutput>& mapOutputs();

/** The one that `path` ends as. Throws Error, listing the known ones. */
const MapOutput& mapOutputFor(const std::string& path);

/** The files written for `path`: itself and its side files. */
std::vector<std::string> filesOf(const std::string& path);
}  // namespace delio
