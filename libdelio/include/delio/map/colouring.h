#pragma once
#include <mrpt/img/TColor.h>

#include <optional>
#include <string>
#include <vector>

#include "delio/map/colormap.h"
#include "delio/map/map_point.h"

namespace delio::map {
/** What the colours of a map's points say. Height: above the ground around them. Normal: its x, y
 *  and z from -1 to 1 as red, green and blue; grey where there is none. The others: as MapPoint has
 *  them. */
enum class ColourBy { Height, Intensity, Time, Normal, Residual, Observations };

/** Names for the command line: "height", "intensity", "time", "normal", "residual",
 *  "observations". */
std::vector<std::string> colourByNames();

/** Throws Error for an unknown name, listing the known ones. */
ColourBy colourByNamed(const std::string& name);

/** How a map is coloured. */
struct Colouring {
    ColourBy by = ColourBy::Height;       //!< what the colours say
    Colormap colormap = Colormap::Turbo;  //!< normals have colours of their own
};

/** A colour a point, and what a legend needs to say what they mean. */
struct Colours {
    std::vector<mrpt::img::TColor> ofPoints;  //!< in the order of the points
    std::string name;                         //!< of what they say: "height above ground"
    std::string unit;                         //!< with the blank before it: " m"; may be empty
    std::optional<ValueRange> range;  //!< that the colour map is laid over; normals have none
};

/** Colours between robust limits of the values. Throws Error where the points do not have what they
 *  are to be coloured by: it is 0 of all of them. */
Colours coloursOf(const MapPoints& points, const Colouring& colouring = {});
}  // namespace delio::map
