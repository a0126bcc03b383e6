#include <algorithm>
#include <utility>

#include "odometry/pipeline.h"
#include "odometry/register_points.h"

namespace delio::odometry {
/** Keeps the map, in which the latest scans were not found, before a new one begins. A map without
 *  a known motion is not kept. */
void PlaneOdometry::leaveMap() {
    if (inlierRatios_.usual == 0) return;
    insertWaiting();
    left_ = LeftMap{std::move(map_),
                    reference_,
                    path_.anchor(),
                    inlierRatios_.usual,
                    place_.scale(),
                    track_,
                    time_s_,
                    0,
                    {}};
}

/** Goes on in the map that was left, as soon as two scans in a row are found there and agree about
 *  where the new map lies in it. The latest scan is at pose_. */
void PlaneOdometry::rejoin(const ScanView& view) {
    constexpr unsigned kMostScans = 20;
    constexpr double kAgree_m = 0.3, kAgree_rad = 1 * M_PI / 180;
    if (!std::holds_alternative<Tracking>(state_)) return;
    const auto& spacing = options().spacing;
    const double lost_s = left_->left_s - left_->reference.time_s;
    Expectation expected{pose_, left_->reference, upright_};
    expected.isGuess = true;
    expected.isUrgent = isUrgent_;
    expected.start.metres =
        std::min(spacing.acceleration / 2 * lost_s * lost_s, spacing.first_speed / 2);
    expected.start.turn_rad = std::min(spacing.first_turn_radps * lost_s, spacing.most_turn_rad);
    expected.reach_m = options().registration.search_radius;
    expected.kernel_m = kernel_m();
    expected.isShaken = isShaken();
    expected.usualInlierRatio = left_->usualInlierRatio;
    constexpr double kTurned_rad = 1;  // about any axis
    PointEstimate found = placeScan(left_->map, view, expected, options()).estimate;
    const double likely = expected.likelyInlierRatio();
    const auto isLikely = [&] { return found.valid && found.inlierRatio >= likely; };
    if (isShaken() && !isLikely())
        found = left_->map.placeTurned(view.coarse, pose_, likely, kTurned_rad);
    const auto before = std::exchange(left_->toThis, std::nullopt);
    if (isLikely()) {
        left_->toThis = found.pose * pose_.inverse();
        const Eigen::Isometry3d off =
            before ? (*before * pose_).inverse() * found.pose : Eigen::Isometry3d::Identity();
        if (before && off.translation().norm() < kAgree_m && angleOf(off.linear()) < kAgree_rad)
            return moveToLeftMap(*left_->toThis);
    }
    if (++left_->scans == kMostScans) left_.reset();
}

/** Takes the map that was left again; `toLeft`: from the new map's frame. */
void PlaneOdometry::moveToLeftMap(const Eigen::Isometry3d& toLeft) {
    path_.correctSince(left_->reference.time_s, left_->left_s, toLeft);
    path_.moveTo(left_->anchor);
    place_.use(left_->scale);
    map_ = std::move(left_->map);
    inlierRatios_.usual = left_->usualInlierRatio;
    track_ = left_->track;
    pose_ = normalised(toLeft * pose_);
    reference_.pose = pose_;
    if (waiting_) waiting_->pose = pose_;
    dynamics_.clear();
    if (speeds_) speeds_->clear();
    start_.reset();
    left_.reset();
}

}  // namespace delio::odometry
