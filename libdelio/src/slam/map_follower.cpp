#include "delio/slam/map_follower.h"

#include "../core/checkpoint.h"
#include "odometry/spin_axis.h"

namespace delio {
void MapFollower::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!up_ && points.cols() > 0) up_ = odometry::upIn(scan.scan.sensorPose, points);
    fixes_.push_back(
        tracker_.add(scan.increment, stillPoints(scan), up_.value_or(Eigen::Vector3d::UnitZ())));
    // undo() needs the fix before the last one.
    if (history_ == History::Last && fixes_.size() > 2) fixes_.erase(fixes_.begin());
}

namespace {
/** Of another map, the state is of no use. */
checkpoint::Label labelOf(const MapTracker& tracker) {
    const auto& map = tracker.map();
    return {"place in the map", checkpoint::textOf({&tracker.options(), &tracker.searchOptions()}) +
                                    std::to_string(map.submaps().size()) + " " +
                                    std::to_string(map.graph().poses().size()) + " " +
                                    std::to_string(map.graph().edges().size())};
}
}  // namespace

void MapFollower::save(std::ostream& out) const { checkpoint::save(out, labelOf(tracker_), *this); }

void MapFollower::restore(std::istream& in) { checkpoint::restore(in, labelOf(tracker_), *this); }

void MapFollower::undo() noexcept {
    tracker_.undo();
    fixes_.pop_back();
}
}  // namespace delio
