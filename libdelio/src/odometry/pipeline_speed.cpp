#include <utility>

#include "odometry/pipeline.h"

namespace delio::odometry {
namespace {
constexpr double kVertical = 0.7;  // of a unit axis
constexpr double kRooms = 0.5;     // scale of places that no vehicle drives through, at most
}  // namespace

/** Counts slow scans in a row of which many points do not lie on the map. A sensor that stands sees
 *  nearly all of it again; this one may drive among vehicles of its own speed. */
void PlaneOdometry::countMisfits(const PlaneEstimate& estimate, double inlierRatio,
                                 double since_s) {
    constexpr double kSlow_mps = 1, kStanding = 0.75;
    const double moved_m = (pose_.translation() - reference_.pose.translation()).norm();
    const bool isMisfit =
        estimate.valid && inlierRatio < kStanding && moved_m < kSlow_mps * since_s && !isShaken();
    misfits_ = isMisfit ? misfits_ + 1 : 0;
}

/** Horizontal axes (map's frame, a column each) along which the scan may follow vehicles that drive
 *  along: the planes that show the translation there are few and lie in one direction, or the
 *  sensor seems to stand where few points fit. */
Eigen::Matrix3Xd PlaneOdometry::axesOfVehicles(const PlaneEstimate& estimate) const {
    constexpr double kThin = 0.05;     // of the planes' weight
    constexpr double kFewSectors = 2;  // that such a vehicle covers
    constexpr unsigned kMisfits = 5;
    const auto& translation = estimate.translation;
    const double observability = translation.observability[0];
    Eigen::Matrix3Xd axes(3, 0);
    if (!estimate.valid || wheels_.areTrusted()) return axes;
    const bool isOneSided = translation.unobservedAxes.cols() == 0 && observability > 0 &&
                            observability < kThin && estimate.weakestSpread < kFewSectors &&
                            place_.scale() > kRooms;
    if (misfits_ >= kMisfits)
        axes = (pose_.linear() * upright_.transpose().cast<double>()).leftCols<2>();
    else if (isOneSided && std::abs(estimate.weakestAxis.dot(upAt(pose_))) < kVertical)
        axes = estimate.weakestAxis;
    return axes;
}

/** Where the scene hardly constrains the translation along a horizontal axis, a wrong speed (a
 *  standstill, above all) confirms itself scan by scan. True where several scans together show
 *  another one: tracking goes on at that speed. */
bool PlaneOdometry::settleSpeed(const PointCloud& cloud, const PlaneEstimate& estimate) {
    if (!speeds_) return false;
    const Eigen::Vector3d& axis = estimate.weakestAxis;
    constexpr double kThinAtFirst = 0.03;  // of the planes' weight
    const double speed_mps = axis.dot(pose_.linear() * prediction_.predict(1).translation());
    const bool isDoubtful =
        (estimate.translation.observability[0] < kThinAtFirst && !beginning_.empty()) ||
        axesOfVehicles(estimate).cols() > 0 || std::abs(speed_mps) > options().spacing.first_speed;
    const bool isHidden = estimate.valid &&
                          (isDoubtful || std::holds_alternative<Degenerate>(state_)) &&
                          place_.scale() > kRooms && !isShaken() && !isUrgent_ &&
                          !wheels_.haveCarried() && std::abs(axis.dot(upAt(pose_))) < kVertical;
    constexpr unsigned kPatience = 4;
    shownSpeeds_ = isHidden ? 0 : shownSpeeds_ + 1;
    if (!estimate.valid || shownSpeeds_ > kPatience) {
        speeds_->clear();
        return false;
    }
    const auto scans =
        speeds_->add({cloud, time_s_, trajectoryOfLatest()}, {axis, speed_mps, upright_});
    if (scans) restartAt(*scans);
    return scans.has_value();
}

/** A new map of the latest scans, which were placed together. */
void PlaneOdometry::restartAt(const std::vector<MovingScan>& scans) {
    endWindow();
    // Since when the speed was wrong is not known, except at a start.
    if (beginning_.empty()) track_ = ++latestTrack_;
    left_.reset();
    dynamics_.clear();
    extrapolation_.reset();
    errors_ = {};
    inlierRatios_.usual = 0;
    prediction_.forget();
    map_.clear(upAt(pose_));
    waiting_.reset();
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const MovingScan& scan = scans[i];
        insertWaiting();
        pose_ = scan.trajectory.at(0);
        motion_ = scan.trajectory.seenFrom(0);
        ScanView view = undistorted(scan.cloud, motion_);
        thinForMap(view, options().spacing.map_spacing);
        if (i > 0)
            prediction_.observe(scans[i - 1].trajectory.at(0).inverse() * pose_,
                                scan.time_s - scans[i - 1].time_s);
        reference_ = {view.points, pose_, scan.time_s};
        waiting_ = PlacedPoints{std::move(view.fine), pose_};
        for (BeginningScan& first : beginning_)
            if (first.scan.time_s == scan.time_s) first = {scan, waiting_, track_};
    }
    state_ = Tracking{};
    // The scans before have to be registered again, too: see retraceStart().
    const Eigen::Isometry3d moved = path_.correct(scans);
    for (auto& [scan, points, track, onPlanes] : beginning_)
        if (scan.time_s < scans.front().time_s)
            scan.trajectory = placed(moved * scan.trajectory.at(0), scan.trajectory.seenFrom(0));
}
}  // namespace delio::odometry
