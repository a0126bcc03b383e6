#pragma once
#include <mrpt/img/TColor.h>

#include <optional>
#include <string>
#include <vector>

#include "delio/map/map_point.h"

namespace delio::map {
/** Turbo shows the most detail; Viridis rises evenly in lightness and is safe for colour-blind
 *  eyes; Gray prints. */
enum class Colormap { Turbo, Viridis, Gray };

/** Names for the command line: "turbo", "viridis", "gray". */
std::vector<std::string> colormapNames();

/** Throws Error for an unknown name, listing the known ones. */
Colormap colormapNamed(const std::string& name);

/** Colour at `t` from 0 (low) to 1 (high); beyond that, the end's colour. */
mrpt::img::TColor colourAt(Colormap colormap, double t);

/** Limits that a range of colours is laid between so that a few outliers do not use it up. */
struct ValueRange {
    double low = 0;   //!< value of the lowest colour
    double high = 1;  //!< value of the highest colour
    /** Where a value lies: 0 at `low`, 1 at `high`. */
    double fractionAt(double value) const { return (value - low) / (high - low); }
};

/** From the 2nd to the 98th percentile of the values that are finite; [0, 1] without any, and
 *  never narrower than 1e-3. */
ValueRange robustRange(std::vector<float> values);

/** Quantity shown by the colours of a map. Height: above the ground around them. Normal: its x, y
 *  and z from -1 to 1 as red, green and blue; grey if unknown. The others: the fields of MapPoint.
 */
enum class ColourBy { Height, Intensity, Time, Normal, Residual, Observations };

/** Names for the command line: "height", "intensity", "time", "normal", "residual",
 *  "observations". */
std::vector<std::string> colourByNames();

/** Throws Error for an unknown name, listing the known ones. */
ColourBy colourByNamed(const std::string& name);

/** How a map is coloured. */
struct Colouring {
    ColourBy by = ColourBy::Height;       //!< quantity shown by the colours
    Colormap colormap = Colormap::Turbo;  //!< normals have colours of their own
};

/** Colours of the points, and the content of the legend. */
struct Colours {
    std::vector<mrpt::img::TColor> ofPoints;  //!< in the order of the points
    std::string name;                         //!< legend text: "height above ground"
    std::string unit;                         //!< with the blank before it: " m"; may be empty
    std::optional<ValueRange> range;  //!< that the colour map is laid over; normals have none
};

/** Colours between robust limits of the values. Throws Error if the points lack this quantity (it
 *  is 0 for all of them). */
Colours coloursOf(const MapPoints& points, const Colouring& colouring = {});
}  // namespace delio::map
