#pragma once
#include <optional>
#include <string>
#include <vector>

#include "delio/earth/georeference.h"
#include "delio/formats/georeference.h"

namespace delio {
/** File with the errors of the points, beside the map `output`. */
std::string controlFileOf(const std::string& output);

/** Reads the control points of `file`. Those that are marked as used place the map anew; without
 *  such a column, all do where it is not yet `place`d. Throws Error where the points cannot be read
 *  or do not determine the place, or where none is used and the map has none. */
std::vector<earth::ControlPoint> placeByControl(const std::string& file,
                                                std::optional<earth::Georeference>& place);

/** The errors of used and of checked points, in a sentence. */
std::string summaryOf(const std::vector<earth::ControlPoint>& points,
                      const earth::Georeference& place);
}  // namespace delio
