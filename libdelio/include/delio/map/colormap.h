#pragma once
#include <mrpt/img/TColor.h>

#include <string>
#include <vector>

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
}  // namespace delio::map
