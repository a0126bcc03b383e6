#include <algorithm>
#include <utility>

#include "odometry/pipeline.h"
#include "odometry/register_points.h"

namespace delio::odometry {
/** Keeps the map, in which the latest scans were not found, before a new one begins. A map without
 *  a known motion is not kept. */
void PlaneOdometry::leaveMap() {
    if (usualInlierRatio_ == 0) return;
    insertWaiting();
    left_ = LeftMap{std::move(map_),
                    reference_,
                    said_ * stamped_.pose.inverse(),
                    usualInlierRatio_,
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
    const auto& spacing = options_.spacing;
    const double lost_s = left_->left_s - left_->reference.time_s;
    Expectation expected{pose_, left_->reference, upright_};
    expected.isGuess = true;
    expected.start.metres =
        std::min(spacing.acceleration / 2 * lost_s * lost_s, spacing.first_speed / 2);
    expected.start.turn_rad = std::min(spacing.first_turn_radps * lost_s, spacing.most_turn_rad);
    expected.reach_m = options_.registration.search_radius;
    expected.kernel_m = kernel_m();
    expected.isShaken = isShaken();
    expected.usualInlierRatio = left_->usualInlierRatio;
    constexpr double kTurned_rad = 1;  // about any axis
    PointEstimate found = placeScan(left_->map, view, expected, options_).estimate;
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
    const auto isBefore = [&](const PastScan& scan) {
        return scan.time_s <= left_->reference.time_s;
    };
    const auto lost = std::find_if_not(past_.begin(), past_.end(), isBefore);
    const auto found = std::find_if(
        lost, past_.end(), [&](const PastScan& scan) { return scan.time_s >= left_->left_s; });
    for (auto scan = lost; scan != past_.end(); ++scan) {
        scan->isCorrected = true;
        if (scan >= found) scan->pose = toLeft * scan->pose;
    }
    // Between both maps the motion is taken to have been even.
    if (lost != past_.begin() && found != past_.end()) {
        const PastScan& last = *std::prev(lost);
        const auto twist =
            Twist::of(last.pose.inverse() * found->pose, found->stamp_s - last.stamp_s);
        for (auto scan = lost; scan != found; ++scan)
            scan->pose = last.pose * twist.after(scan->stamp_s - last.stamp_s);
    }
    stamped_.pose = left_->toSaid.inverse() * said_;
    map_ = std::move(left_->map);
    usualInlierRatio_ = left_->usualInlierRatio;
    track_ = left_->track;
    pose_ = normalised(toLeft * pose_);
    reference_.pose = pose_;
    if (waiting_) waiting_->pose = pose_;
    dynamics_.clear();
    start_.reset();
    left_.reset();
}

/** Says where earlier scans are now known to have been. */
void PlaneOdometry::correctPast(Step& step) {
    constexpr std::size_t kMostScans = 40;
    said_ = normalised(said_ * step.increment.pose);
    if (start_)
        for (auto& scan : past_)
            if ((scan.isCorrected = scan.stamp_s >= start_->stamp_s))
                scan.pose = window_.trajectory().at(scan.stamp_s);
    for (std::size_t i = 0; i < past_.size(); ++i) {
        if (!std::exchange(past_[i].isCorrected, false)) continue;
        const Eigen::Isometry3d fromHere = normalised(stamped_.pose.inverse() * past_[i].pose);
        past_[i].said = said_ * fromHere;
        step.corrected.push_back({past_.size() - i, fromHere});
    }
    past_.push_back({stamped_.time_s, stamped_.time_s + stamped_.stamp_s, stamped_.pose, said_});
    if (past_.size() > kMostScans) past_.pop_front();
}
}  // namespace delio::odometry
