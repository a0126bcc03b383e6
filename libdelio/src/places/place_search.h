#pragma once
#include <memory>
#include <string>
#include <vector>

#include "delio/places/localisation.h"
#include "delio/places/stored_map.h"
#include "places/closure.h"
#include "places/place_index.h"

namespace delio {
/** Result of a place search: pose in the map, or the reason of the failure. */
struct FoundPlace {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< the cloud's frame to the map's
    double overlap = 0;   //!< RegistrableSubmap::support() of the cloud by the map
    double conflict = 0;  //!< FreeSpace::conflict(), the larger of both directions
    /** Overlap times inlier ratio, less twice RegistrableSubmap::seenThrough(). A similar room
     * fills many of the same voxels, but its walls are on other planes, and the cloud saw through
     * some. */
    double similarity = 0;
    double closeness = 0;    //!< RegistrableSubmap::closeness() of the cloud to the map
    double rival = 0;        //!< score() of the second-best place
    std::size_t submap = 0;  //!< of the map, in which it was found
    std::string reason;      //!< empty: it was found

    /** By which places are compared. */
    double score() const { return similarity * closeness; }
};

/** Finds a levelled cloud in a stored map without an initial guess. All places and headings are
 *  compared coarsely (PlaceIndex), the best ones in the descriptors' resolution, rotation first;
 * then they are registered. Verification is that of loops, and more: enough overlap, no walls in
 * the other's free space, few walls that the cloud saw through, and no second place that is nearly
 * as good. */
class PlaceSearch {
 public:
    /** Reads the descriptors of all submaps of `map`. Error if they are damaged. */
    PlaceSearch(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& options);

    const PlaceSearchOptions& options() const { return options_; }  //!< that it was made with

    /** `cloud`: z up, metres, as seen from about its origin. */
    FoundPlace find(const Eigen::Matrix3Xf& cloud);
    /** Among some submaps only. */
    FoundPlace find(const Eigen::Matrix3Xf& cloud, const std::vector<std::size_t>& submaps);

 private:
    struct Hypothesis {
        std::size_t place;
        places::Shift shift;
    };
    std::vector<Hypothesis> hypotheses(const std::vector<places::PlaceMatch>& matches,
                                       const places::Descriptor& seen) const;
    /** The cloud that is searched for. */
    struct Seen {
        const places::Descriptor& descriptor;
        places::DenseSubmap dense;
        odometry::RangeImage ranges;
    };
    FoundPlace registered(const Hypothesis& hypothesis, const places::DenseSubmap& place,
                          const Seen& seen) const;
    std::vector<FoundPlace> registered(const std::vector<Hypothesis>& hypotheses, const Seen& seen);
    std::vector<Hypothesis> beside(const FoundPlace& found, const Seen& seen) const;
    FoundPlace verified(const std::vector<places::PlaceMatch>& matches,
                        const Eigen::Matrix3Xf& cloud, const places::Descriptor& descriptor);

    std::shared_ptr<const StoredMap> map_;
    PlaceSearchOptions options_;
    std::vector<places::Descriptor> descriptors_;
    places::PlaceIndex index_;
    places::DenseSubmapCache cache_{6};
};
}  // namespace delio
