#pragma once
#include <optional>
#include <variant>

#include "odometry/preprocess.h"
#include "odometry/register_together.h"

namespace delio::odometry {
/** There is no map: no usable scan yet, or too few points to begin another map. */
struct Empty {
    bool hasSeenScans = false;  //!< scans came, but none that a map can begin with
};

/** The map holds one scan alone, against which the next one is registered. */
struct FirstScan {
    /** The scan as it came, where its points have times. It is de-skewed as soon as the second scan
     *  shows the motion. */
    std::optional<PointCloud> skewed;
    /** The same, prepared while the second one is awaited. */
    std::optional<TimedScan> timed;
    bool motionIsKnown = false;  //!< the map replaces another one, through which the scans led
    unsigned misses = 0;         //!< scans in a row that were not found in it
};

/** The latest scan was registered along every axis. */
struct Tracking {};

/** The latest scan was registered, but the scene does not constrain the translation along every
 *  axis: the pose along the others is the prediction. */
struct Degenerate {
    unsigned scans = 1;      //!< in a row, up to this one
    double inlierRatio = 0;  //!< of the first of them
};

/** The latest scan was not found in the map, or the time before it is not known: the next one may
 *  be metres off the prediction. */
struct Lost {
    unsigned misses = 0;  //!< scans in a row that were not found
};

/** What the odometry knows before a scan. Transitions: Empty -> FirstScan (a usable scan);
 *  FirstScan, Lost -> Tracking, Degenerate (registered); any -> Lost (not found, or a pause);
 *  Lost, FirstScan -> FirstScan (three scans not found: a new map); Tracking, Degenerate ->
 *  FirstScan (the place has another size, or planes show a wrong tilt: a new map);
 *  Degenerate -> FirstScan (ever fewer points fit: a new map), Tracking (several scans show the
 *  speed). */
using TrackingState = std::variant<Empty, FirstScan, Tracking, Degenerate, Lost>;

/** True where the pose of the next scan is not known to better than metres. */
inline bool isLost(const TrackingState& state) {
    if (const auto* first = std::get_if<FirstScan>(&state)) return !first->motionIsKnown;
    return std::holds_alternative<Empty>(state) || std::holds_alternative<Lost>(state);
}

/** Scans in a row that were not found in the map. */
inline unsigned missesOf(const TrackingState& state) {
    if (const auto* first = std::get_if<FirstScan>(&state)) return first->misses;
    if (const auto* lost = std::get_if<Lost>(&state)) return lost->misses;
    return 0;
}

/** The state after a scan whose motion is not known; `misses`: see missesOf(). A map of one scan
 *  stays one. */
inline TrackingState lostFrom(TrackingState state, unsigned misses) {
    if (std::holds_alternative<Empty>(state)) return state;
    auto* first = std::get_if<FirstScan>(&state);
    if (!first) return Lost{misses};
    first->motionIsKnown = false;
    first->misses = misses;
    return state;
}
}  // namespace delio::odometry
