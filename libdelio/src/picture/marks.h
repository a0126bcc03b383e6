#pragma once
#include <algorithm>

#include "delio/picture/view.h"

namespace delio::picture {
/** The name of a scene's object that holds the points of a map. */
constexpr const char* kMapName = "map";

/** Of the one that holds what was taken out of it. */
constexpr const char* kRemovedName = "removed";

/** How much larger than in a picture of 1080 lines marks, texts and points are. */
inline double sizeOfMarks(const SnapshotOptions& options) {
    const double lines = std::min(options.width_px / 16.0 * 9, double(options.height_px));
    return std::clamp(lines / 1080, 0.6, 4.0);
}

/** Smaller pictures have no room for a legend. */
inline bool hasLegend(const SnapshotOptions& options) {
    return options.width_px >= 480 && options.height_px >= 320;
}
}  // namespace delio::picture
