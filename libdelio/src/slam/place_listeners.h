#pragma once
#include <exception>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "delio/places/submap.h"
#include "delio/slam/slam.h"
#include "places/close_loops.h"
#include "places/map_tracker.h"

namespace delio {
/** Stores a drive as submaps, searches for revisited places during the drive, and closes the loops
 *  at its end. The search has a thread of its own (where more than one may be used), and finds the
 *  same whenever it gets the time. */
class LoopCloser : public SlamListener {
 public:
    /** `folder`: where submaps are put aside, see LoopSearch. */
    LoopCloser(const places::SubmapOptions& submaps, const places::LoopOptions& loops,
               const places::ClosureOptions& closures, const std::string& folder = "");

    const char* name() const override { return "submaps"; }
    void add(const SlamScan& scan) override;

    /** `graph`: of the same drive, a node each scan. Once, after the last scan. Error where submaps
     *  could not be put aside. */
    places::ClosedLoops close(const graph::PoseGraph& graph,
                              const graph::PoseGraphOptions& optimisation);

    /** State needed to close the loops. */
    const places::LoopSearch& search() const { return search_; }
    /** Time that the search has taken, beside the drive and after it. */
    double search_ms() const { return search_ms_; }

 private:
    struct Ended {
        std::future<places::Submap> submap;
        std::vector<Eigen::Isometry3d> poses;  //!< of its nodes
    };
    void end(std::future<places::Submap> submap);
    void searchNext() noexcept;
    void searchTaken() noexcept;

    places::SubmapBuilder builder_;
    std::vector<Eigen::Isometry3d> poses_;  //!< of the nodes of the submap that is being made
    std::vector<Ended> waiting_;            //!< submaps that are not searched for yet
    std::vector<Ended> taken_;              //!< belongs, as search_, to the thread while it is busy
    places::LoopSearch search_;             //!< belongs to the thread while that is busy
    double search_ms_ = 0;
    std::exception_ptr fault_;  //!< of the search
    bool upIsKnown_ = false;
    Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  //!< in the vehicle's frame
    std::future<void> busy_;                         //!< the last one: ends before what it uses
};

/** Follows a drive through a stored map. */
class MapFollower : public SlamListener {
 public:
    /** `tracker`: of the map. `history`: which fixes are kept. */
    explicit MapFollower(MapTracker tracker, History history = History::All)
        : tracker_(std::move(tracker)), history_(history) {}

    /** See MapTracker. */
    void expect(const Eigen::Isometry3d& vehicle) { tracker_.expect(vehicle); }

    const char* name() const override { return "localisation"; }
    void add(const SlamScan& scan) override;

    /** One for each scan; with History::Last that of the last scan. */
    const std::vector<MapFix>& fixes() const { return fixes_; }
    const StoredMap& map() const { return tracker_.map(); }  //!< that is followed through

 private:
    MapTracker tracker_;
    History history_;
    std::vector<MapFix> fixes_;
    std::optional<Eigen::Vector3d> up_;  //!< in the vehicle's frame, once it is known
};
}  // namespace delio
