#include <utility>

#include "odometry/pipeline.h"

namespace delio::odometry {
ScanTrajectory PlaneOdometry::refined(const ScanTrajectory& start, const KnownEnds& known,
                                      const PointCloud& cloud, const ScanView& view) const {
    return refinedTrajectory(map_.planes(), start, known.since_s, cloud, view, errors().unevenness,
                             kernel_m(), options());
}

/** From the one pose to the other and on, until the last point of `cloud`, turned as the gyroscope
 *  says. As constantTwist(). */
std::optional<ScanTrajectory> PlaneOdometry::trajectoryByGyro(const KnownEnds& known,
                                                              const PointCloud& cloud) const {
    if (!usesGyro_) return {};
    const Eigen::Vector3d velocity =
        (known.pose.translation() - known.reference.translation()) / known.since_s;
    return gyro_.trajectory(known.pose, velocity, time_s_, -known.since_s, endsOf(cloud).second);
}

/** The scan that the map began with, which is all there is in it, as seen on this trajectory. */
void PlaneOdometry::deskewFirst(const PointCloud& first, const ScanTrajectory& trajectory) {
    for (auto& [scan, points, track, onPlanes] : beginning_)
        if (scan.time_s == reference_.time_s) scan.trajectory = placed(reference_.pose, trajectory);
    ScanView view = undistorted(first, trajectory);
    thinForMap(view, options().spacing.map_spacing);
    map_.clear(upAt(reference_.pose));
    map_.addScan(view.fine, reference_.pose);
    reference_.points = std::move(view.points);
}

/** The second scan shows the motion during the first one, and the first one that during the second.
 *  A skewed first scan bends the trajectory of the second as it is bent itself: both are de-skewed
 *  again and again, as long as more points fit. */
std::optional<ScanOnTrajectory> PlaneOdometry::deskewPair(const PointCloud& first, KnownEnds known,
                                                          const PointCloud& cloud,
                                                          const ScanView& view) {
    constexpr unsigned kMostRounds = 10, kPatience = 2;
    constexpr double kClearly = 0.002;  // smaller differences of the inlier ratio are noise
    std::optional<ScanOnTrajectory> best;
    for (unsigned round = 0, worse = 0; round < kMostRounds && worse < kPatience; ++round) {
        const ScanTrajectory trajectory =
            round == 0 ? constantTwist(known, cloud)
                       : refined(constantTwist(known, cloud), known, cloud, view);
        deskewFirst(first, trajectory.seenFrom(-known.since_s));
        auto next = registerAlong(trajectory, known, map_, cloud, view, options());
        if (!next) break;
        known.pose = next->estimate.pose();
        const double gained = best ? next->inlierRatio - best->inlierRatio : 1;
        worse = gained > kClearly ? 0 : worse + 1;
        if (gained > 0) best = std::move(next);
    }
    if (best) deskewFirst(first, best->trajectory.seenFrom(-known.since_s));
    return best;
}

/** By a motion of varying speed, in a swinging hand again and again as long as clearly more points
 *  fit; or by one of constant speed where clearly fewer than before fit then. */
std::optional<ScanOnTrajectory> PlaneOdometry::deskewByMotion(const KnownEnds& known,
                                                              double inlierRatio,
                                                              const PointCloud& cloud,
                                                              const ScanView& view) const {
    const unsigned mostRounds = isShaken() ? 6 : 1;
    const auto along = [&](const ScanTrajectory& trajectory) {
        return registerAlong(trajectory, known, map_, cloud, view, options());
    };
    const ScanTrajectory constant =
        trajectoryByGyro(known, cloud).value_or(constantTwist(known, cloud));
    auto best = along(refined(constant, known, cloud, view));
    for (unsigned round = 1; round < mostRounds && best; ++round) {
        auto next = along(refined(best->trajectory, known, cloud, view));
        if (!next || next->inlierRatio < best->inlierRatio + kInlierNoise) break;
        best = std::move(next);
    }
    return best && best->inlierRatio >= inlierRatio - kInlierNoise ? best : along(constant);
}

/** De-skews the scan by the motion that was found and registers it again: by a motion of varying
 *  speed, or by one of constant speed where clearly fewer points fit then. Where that does not fit
 *  either, the scan stays de-skewed by the prediction, as which it was `placed`. */
std::optional<ScanOnTrajectory> PlaneOdometry::deskewAgain(const PointCloud& cloud, double since_s,
                                                           const PointEstimate& placed,
                                                           const Eigen::Isometry3d& predicted,
                                                           const Eigen::Isometry3d& pose,
                                                           const ScanView& view) {
    const bool isNear =
        !isShaken() && stepBetween(predicted, pose).norm() < options().spacing.map_spacing;
    KnownEnds known{reference_.pose, since_s,  pose, upright_, isPlacedByStanding(isGuessing()),
                    isNear,          motion(), {}};
    if (isSettled()) known.placed = PlacedScan{placed, motion_};
    const auto fits = [&](const std::optional<ScanOnTrajectory>& found) {
        return found && found->inlierRatio >= placed.inlierRatio - kInlierNoise;
    };
    std::optional<ScanOnTrajectory> found;
    const auto* first = std::get_if<FirstScan>(&state_);
    const bool isPair = first && first->skewed;
    if (isPair)
        found = deskewPair(*first->skewed, known, cloud, view);
    else
        found = deskewByMotion(known, placed.inlierRatio, cloud, view);
    if (!isPair && !fits(found)) return {};
    return found;
}
}  // namespace delio::odometry
