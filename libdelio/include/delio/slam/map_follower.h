#pragma once
#include <memory>
#include <vector>

#include "delio/localisation/map_tracker.h"
#include "delio/slam/listener.h"

namespace delio {
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
