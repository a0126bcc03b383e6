#pragma once
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/voxel_table.h"
#include "delio/core/increment.h"
#include "delio/places/localisation.h"
#include "delio/places/stored_map.h"
#include "odometry/local_map.h"
#include "places/place_search.h"

namespace delio {
/** The part of a stored map about a place, for the registration of scans. Submaps are loaded as
 * they come near, a few points at a time, and dropped when they are far. */
class LoadedMap {
 public:
    /** Empty: see load(). */
    explicit LoadedMap(std::shared_ptr<const StoredMap> map);

    /** Loads all submaps near `place` (the map's frame). */
    void load(const Eigen::Vector3d& place);
    /** The same, but at most as many points as one scan has time for. */
    void follow(const Eigen::Vector3d& place);

    /** Points and planes of what is near, in the map's frame. */
    const odometry::LocalMap& map() const { return map_; }

    /** Fraction of the points within `distance` metres of one of the map's, 0 to 1. Points higher
     *  than anything that the map has in their column are not counted (another sensor may see
     *  higher), but at most 70 % of them. `pose`: maps the points to the map's frame. */
    double shareAt(const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
                   double distance) const;

 private:
    void comeNear(const Eigen::Vector3d& place);
    void take(Eigen::Index most);
    void raiseTops(const Eigen::Matrix3Xd& points);

    struct Cloud {
        std::size_t submap = 0;
        Eigen::Matrix3Xf points;  //!< of it
        Eigen::Index taken = 0;
    };
    std::shared_ptr<const StoredMap> stored_;
    std::vector<bool> isNear_;  //!< of each submap: it was taken in, or waits
    std::deque<Cloud> waiting_;
    odometry::LocalMap map_;
    VoxelIndex columns_;        //!< of 1 m in which the map has anything
    std::vector<double> tops_;  //!< of each of them
};

/** Tracks a vehicle in a stored map: predicts by its odometry and registers each scan to the map.
 * It finds the vehicle without an initial guess, notices when it leaves the map, continues with the
 *  odometry alone and finds it again. A place counts as found when the next scans confirm it. */
class MapTracker {
 public:
    /** The vehicle may be anywhere in `map`, or not in it. See expect(). */
    MapTracker(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& search,
               const LocalisationOptions& options);

    /** The vehicle's pose in the map's frame at the next scan, if it is known to some metres. */
    void expect(const Eigen::Isometry3d& vehicle);

    /** Adds the next scan: the vehicle's increment, its static points in the vehicle's frame, and
     *  the unit vector that points up there. */
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
        Belief otherwise;             //!< hypothesis used if the next scans do not confirm this one
        double usualInlierRatio = 0;  //!< running mean of MapFix::inlierRatio; 0: not known
        unsigned confirmed = 0;       //!< scans in a row that agree with the map
        unsigned missed = 0;          //!< and that do not
        double unsearched_m = 0;      //!< path since it was searched for
        std::size_t inVain = 0;       //!< searches since it was in the map
        std::size_t scans = 0;
        Eigen::Isometry3d odometry = Eigen::Isometry3d::Identity();
        std::deque<Seen> recent;  //!< the latest last
    };
    void remember(const Eigen::Matrix3Xf& points);
    std::optional<Increment> track(const Eigen::Matrix3Xf& points, const Eigen::Matrix3d& level,
                                   const Increment& predicted, MapFix& fix);
    void judge(const std::optional<Increment>& found, double inlierRatio);
    bool isTimeToSearch() const;
    Eigen::Matrix3Xf recentCloud(const Eigen::Matrix3d& level) const;
    std::optional<Increment> search(const Eigen::Matrix3d& level, MapFix& fix);
    std::vector<std::size_t> nearSubmaps(double reach_m) const;
    double reach_m() const;

    std::shared_ptr<const StoredMap> map_;
    LocalisationOptions options_;
    PlaceSearch search_;
    LoadedMap local_;
    State now_;
};
}  // namespace delio
