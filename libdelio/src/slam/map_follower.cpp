#include "delio/slam/map_follower.h"

#include "delio/scan/spin_axis.h"

namespace delio {
void MapFollower::add(const SlamScan& scan) {
    const auto& points = scan.step.used.points;
    if (!up_ && points.cols() > 0) up_ = scan::upIn(scan.scan.sensorPose, points);
    if (history_ == History::Last) fixes_.clear();
    fixes_.push_back(
        tracker_.add(scan.increment, stillPoints(scan), up_.value_or(Eigen::Vector3d::UnitZ())));
}
}  // namespace delio
