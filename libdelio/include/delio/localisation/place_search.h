#pragma once
#include <memory>
#include <vector>

#include "delio/localisation/stored_map.h"
#include "delio/loops/grounds.h"
#include "delio/loops/place_index.h"

namespace delio {
/** When a place counts as found. */
struct PlaceSearchOptions : public StageOptions {
    double min_overlap = 0.45;
    double max_bare = 0.2;
    double rival = 0.8;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A place of the map that a cloud was recognised at, or why none was. */
struct FoundPlace {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< the cloud's frame to the map's
    double overlap = 0;      //!< of what stands in the cloud so much stands in the map
    double bare = 0;         //!< of the walls of one so much is free space of the other
    double rival = 0;        //!< overlap at another place where it could be, too
    std::size_t submap = 0;  //!< number of the map's submap that it was found by
    std::string reason;      //!< empty: it was found
};

/** Finds a levelled cloud in a stored map, knowing nothing of where it was taken: all places and
 *  headings are compared by what stands on the ground (PlaceIndex), the best ones in fine, rotation
 *  first, then registered; and verified as loops are: what stands has to meet, walls must not lie
 *  on what the other saw as free space, and no place elsewhere may look as good. */
class PlaceSearch {
 public:
    /** Reads what all submaps of `map` are found by. Error where that is damaged. */
    PlaceSearch(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& options);

    const PlaceSearchOptions& options() const { return options_; }  //!< that it was made with

    /** `cloud`: z up, metres. */
    FoundPlace find(const Eigen::Matrix3Xf& cloud);
    /** Among some submaps only. */
    FoundPlace find(const Eigen::Matrix3Xf& cloud, const std::vector<std::size_t>& submaps);

 private:
    struct Hypothesis {
        std::size_t place;
        loops::Shift shift;
    };
    std::vector<Hypothesis> hypotheses(const std::vector<loops::Sighting>& sightings,
                                       const loops::Sketch& seen) const;
    FoundPlace registered(const Hypothesis& hypothesis, const loops::Ground& place,
                          const loops::Sketch& seen, const loops::Ground& cloud) const;
    FoundPlace verified(const std::vector<loops::Sighting>& sightings,
                        const Eigen::Matrix3Xf& cloud, const loops::Sketch& seen);

    std::shared_ptr<const StoredMap> map_;
    PlaceSearchOptions options_;
    std::vector<loops::Sketch> sketches_;
    loops::PlaceIndex index_;
    loops::Grounds grounds_{6};
};
}  // namespace delio
