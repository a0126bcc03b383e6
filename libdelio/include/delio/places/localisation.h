#pragma once
#include <string>

#include "delio/core/increment.h"
#include "delio/core/stage_options.h"

namespace delio {
/** Acceptance of a place. */
struct PlaceSearchOptions : public StageOptions {
    double min_overlap = 0.45;
    double rival = 0.8;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Tracking and search in a stored map. */
struct LocalisationOptions : public StageOptions {
    double drift = 0.01;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Localisation state with respect to a map. */
enum class Whereabouts {
    kUnknown,  //!< not found yet
    kInMap,
    kOutside  //!< it has left the map: the pose is the odometry's since then
};

/** Pose of the vehicle in a stored map at a scan. */
struct MapFix {
    Whereabouts where = Whereabouts::kUnknown;  //!< with respect to the map
    Increment vehicle;       //!< its pose in the map's frame; not set where it is unknown
    bool measured = false;   //!< by registration to the map; otherwise by the odometry
    bool searched = false;   //!< a global search was made at this scan
    double inlierRatio = 0;  //!< fraction of the points above the ground that are in the map
    std::string reason;      //!< why it was not measured
};

/** True if the pose was measured in the map and confirmed. */
bool isAnchor(const MapFix& fix);
}  // namespace delio
