#include "odometry/reported_path.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "delio/core/geometry.h"

namespace delio::odometry {
Eigen::Isometry3d ReportedPath::advance(const Stamped& latest, const Eigen::Isometry3d& before) {
    latest_ = latest;
    return normalised(before.inverse() * latest.pose);
}

void ReportedPath::correctStamp(const Eigen::Isometry3d& pose) {
    if (scans_.empty()) return;
    Scan& before = scans_.back();
    before.at.pose = pose;
    before.staysInPlace = !std::exchange(before.isCorrected, true);
}

void ReportedPath::correctSince(double from_s, const ScanTrajectory& trajectory) {
    for (Scan& scan : scans_) {
        scan.isCorrected = scan.stamp_s >= from_s;
        scan.staysInPlace = false;
        if (scan.isCorrected) scan.at.pose = trajectory.at(scan.stamp_s);
    }
}

void ReportedPath::correctSince(double lost_s, double left_s, const Eigen::Isometry3d& toLeft) {
    const auto lost = std::find_if(scans_.begin(), scans_.end(),
                                   [&](const Scan& scan) { return scan.time_s > lost_s; });
    const auto found =
        std::find_if(lost, scans_.end(), [&](const Scan& scan) { return scan.time_s >= left_s; });
    for (auto scan = lost; scan != scans_.end(); ++scan) {
        scan->isCorrected = true;
        if (scan >= found) scan->at.pose = toLeft * scan->at.pose;
    }
    if (lost == scans_.begin() || found == scans_.end()) return;
    const Scan& last = *std::prev(lost);
    const auto twist =
        Twist::of(last.at.pose.inverse() * found->at.pose, found->stamp_s - last.stamp_s);
    for (auto scan = lost; scan != found; ++scan)
        scan->at.pose = last.at.pose * twist.after(scan->stamp_s - last.stamp_s);
}

Eigen::Isometry3d ReportedPath::correct(const std::vector<MovingScan>& scans) {
    constexpr double kSoon_s = 0.5;
    const MovingScan& earliest = scans.front();
    auto first = std::find_if(scans_.begin(), scans_.end(),
                              [&](const Scan& scan) { return scan.time_s >= earliest.time_s; });
    if (first == scans_.end()) return Eigen::Isometry3d::Identity();
    // The motion since the scan before was not known, either.
    const bool isBefore =
        first != scans_.begin() && std::prev(first)->time_s > earliest.time_s - kSoon_s;
    if (isBefore) --first;
    const Anchor held = first->at;
    if (isBefore) {
        first->at.pose = earliest.trajectory.at(first->stamp_s - earliest.time_s);
        first->isCorrected = true;
    }
    for (const MovingScan& moved : scans)
        for (auto scan = first; scan != scans_.end(); ++scan)
            if (scan->time_s == moved.time_s) {
                scan->at.pose = moved.trajectory.at(scan->stamp_s - moved.time_s);
                scan->isCorrected = scan->isRegistered = true;
            }
    // The first of them stays where it was said to be.
    Eigen::Isometry3d moved = first->at.pose * held.pose.inverse();
    for (auto scan = scans_.begin(); scan != first; ++scan) scan->at.pose = moved * scan->at.pose;
    moveTo({first->at.pose, held.reported});
    return moved;
}

void ReportedPath::report(Step& step) {
    constexpr std::size_t kMostScans = 40;
    reported_ = normalised(reported_ * step.increment.pose);
    for (std::size_t i = 0; i < scans_.size(); ++i) {
        if (!std::exchange(scans_[i].isCorrected, false)) continue;
        const Eigen::Isometry3d fromHere = normalised(latest_.pose.inverse() * scans_[i].at.pose);
        scans_[i].at.reported = reported_ * fromHere;
        step.corrected.push_back({scans_.size() - i, fromHere,
                                  std::exchange(scans_[i].isRegistered, false),
                                  std::exchange(scans_[i].staysInPlace, false)});
    }
    scans_.push_back({latest_.time_s, latest_.sinceStart_s(), anchor()});
    if (scans_.size() > kMostScans) scans_.pop_front();
}
}  // namespace delio::odometry
