#pragma once
#include <cstddef>
#include <string>

#include "delio/places/stored_map.h"

namespace delio {
/** What became of a cloud of another program. */
struct ImportFigures {
    std::size_t points = 0;    //!< in the cloud
    std::size_t outliers = 0;  //!< of these dropped: more than 50 km from the others
    std::size_t kept = 0;      //!< points of the map
    std::size_t submaps = 0;   //!< squares of 30 m that have points
    std::size_t places = 0;    //!< of these: with free ground, where a drive can be found
    CloudOrigin origin;        //!< as the map has it
    double tilt_deg = 0;       //!< between the cloud's z axis and the normal of its ground
};

/** Makes a stored map of a .ply, .pcd or .las cloud (metres, z up within 30 degrees, any origin),
 *  so that a drive can be localised in it. Poses in the map are the cloud's coordinates less
 *  CloudOrigin::offset. Memory depends on the surface that the cloud covers, not on its number of
 *  points: about 40 bytes for each point that is kept, one in `spacing_m` (0.05 to 2 m).
 *  Throws Error where the cloud cannot be read, has no ground, is too large, or the map cannot be
 *  written. The same cloud gives the same bytes. */
ImportFigures importCloud(const std::string& cloud, double spacing_m, const std::string& map);
}  // namespace delio
