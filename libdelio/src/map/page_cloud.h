#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "delio/map/colouring.h"
#include "delio/map/map_point.h"
#include "map/ground.h"

namespace delio::map {
/** Values of the lowest and the highest stored number. */
struct PageScales {
    ValueRange intensity, time_s;
};

PageScales pageScalesOf(const MapPoints& points);

/** Points as a page has them: cubes of space, so that 16 bits are a millimetre however long the
 *  drive is, and what is behind the eye is not drawn. */
struct PageCloud {
    static constexpr double kTile_m = 65;  // 65000 mm
    static constexpr double kQuantum_m = 1e-3;
    static constexpr double kLowestGround_m = -10;
    static constexpr double kGroundQuantum_m = 1e-2;

    struct Tile {
        std::array<double, 3> origin_m;
        std::size_t begin, count;
    };
    std::vector<Tile> tiles;
    std::vector<std::uint16_t> places;  //!< x, y, z from the tile's origin; height above the ground
    std::vector<std::uint8_t> known;    //!< intensity, observations, time (low byte, high byte)

    std::size_t size() const { return places.size() / 4; }
};

/** The points at a finite place, no more than `most` of them, evenly. */
MapPoints thinned(const MapPoints& points, std::size_t most);

/** Within a tile the first tenth of the points (or any other share) is an even choice of them: a
 *  page draws that while the view moves. */
PageCloud pageCloudOf(const MapPoints& points, const PageScales& scales,
                      const GroundHeight& ground);

/** Lines of base64 with a whole number of bytes each, kBase64Line characters but for the last. */
constexpr std::size_t kBase64Line = 8192;
void writeBase64(const std::uint8_t* bytes, std::size_t count, std::ostream& out);

/** The files of share/page by name, as they were when the library was built. */
const std::map<std::string, std::string>& pageTexts();
}  // namespace delio::map
