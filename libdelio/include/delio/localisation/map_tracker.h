#pragma once
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "delio/core/increment.h"
#include "delio/localisation/local_map.h"
#include "delio/localisation/place_search.h"

namespace delio {
/** When a vehicle counts as lost, and how it is searched for. */
struct LocalisationOptions : public StageOptions {
    double min_share = 0.5;
    double drift = 0.01;
    double search_spacing = 5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Where a vehicle is with respect to a map. */
enum class Whereabouts {
    kUnknown,  //!< not found yet
    kInMap,
    kOutside  //!< it has left the map: the pose is the odometry's since then
};

/** What is known of the vehicle's place in a stored map at a scan. */
struct MapFix {
    Whereabouts where = Whereabouts::kUnknown;  //!< with respect to the map
    Increment vehicle;      //!< its pose in the map's frame; where unknown, nothing
    bool measured = false;  //!< registered to the map, otherwise from the odometry
    bool searched = false;  //!< all places were compared
    double share = 0;       //!< of what stands in the scan so much stands in the map
    std::string reason;     //!< why it was not measured
};

/** Follows a vehicle through a stored map by the steps of its odometry, each scan registered to the
 *  map: finds it without a guess, says when it has left the map, goes on by the odometry and finds
 *  it again when it comes back. A place counts as found when the scans after it confirm it. */
class MapTracker {
 public:
    /** In `map`, of which nothing is known but what expect() says. */
    MapTracker(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& search,
               const LocalisationOptions& options);

    /** The vehicle's pose in the map's frame at the next scan, if it is known to some metres. */
    void expect(const Eigen::Isometry3d& vehicle);

    /** The next scan: the vehicle's increment since the one before; what stands still of it, in the
     *  vehicle's frame; the unit vector that points up there. */
    MapFix add(const Increment& increment, const Eigen::Matrix3Xf& points,
               const Eigen::Vector3d& up);

    const StoredMap& map() const { return *map_; }                   //!< that it was made with
    const LocalisationOptions& options() const { return options_; }  //!< that it was made with
    /** That it was made with. */
    const PlaceSearchOptions& searchOptions() const { return search_.options(); }

 private:
    struct Seen {
        Eigen::Isometry3d pose;  //!< by the odometry
        Eigen::Matrix3Xf points;
    };
    /** In the map, as far as it is known. */
    struct Belief {
        std::optional<Increment> vehicle;
        double unseen_m = 0;  //!< path since it was measured
    };
    struct State {
        Whereabouts where = Whereabouts::kUnknown;
        Belief belief;
        Belief otherwise;        //!< what is believed if the next scans do not confirm that
        double usualShare = 0;   //!< of what stands in a scan, that stands in the map; 0: not known
        unsigned confirmed = 0;  //!< scans in a row that agree with the map
        unsigned missed = 0;     //!< and that do not
        double unsearched_m = 0;  //!< path since it was searched for
        std::size_t inVain = 0;   //!< searches since it was in the map
        std::size_t scans = 0;
        Eigen::Isometry3d odometry = Eigen::Isometry3d::Identity();
        std::deque<Seen> recent;  //!< the latest last
    };
    void remember(const Eigen::Matrix3Xf& points);
    std::optional<Increment> track(const Eigen::Matrix3Xf& points, const Eigen::Matrix3d& level,
                                   const Increment& predicted, MapFix& fix);
    void judge(const std::optional<Increment>& found, double share);
    bool isTimeToSearch() const;
    Eigen::Matrix3Xf recentCloud(const Eigen::Matrix3d& level) const;
    std::optional<Increment> search(const Eigen::Matrix3d& level, MapFix& fix);
    std::vector<std::size_t> nearSubmaps(double reach_m) const;
    double reach_m() const;

    std::shared_ptr<const StoredMap> map_;
    LocalisationOptions options_;
    PlaceSearch search_;
    LocalMap local_;
    State now_;
};
}  // namespace delio
