#include "drive.h"

#include <algorithm>
#include <cmath>

#include "speed_profile.h"

namespace delio::synth {
Drive::Drive(const Road& road, std::size_t scans, std::uint64_t seed)
    : road_(road), motion_(road.givenMotion()) {
    if (!motion_) {
        own_ = std::make_shared<SpeedProfile>(road.path(), road.profile().style, seed);
        motion_ = own_.get();
    }
    const double known = std::floor(motion_->duration_s() / kScanPeriod_s + 1e-6);
    scans_ = std::min(scans, static_cast<std::size_t>(known) + 1);
}

Eigen::Isometry3d Drive::lidarPoseAt(double time_s) const {
    constexpr double kHalfWheelbase = 1.35, kHalfTrack = 0.75;
    const PlanPose plan = motion_->at(time_s);
    const Eigen::Vector2d ahead(std::cos(plan.yaw), std::sin(plan.yaw));
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    const auto wheel = [&](double along, double side) {
        const Eigen::Vector2d place = Eigen::Vector2d(plan.x, plan.y) + along * ahead + side * left;
        return Eigen::Vector3d(place.x(), place.y(), road_.height(place));
    };
    const Eigen::Vector3d fl = wheel(kHalfWheelbase, kHalfTrack);
    const Eigen::Vector3d fr = wheel(kHalfWheelbase, -kHalfTrack);
    const Eigen::Vector3d rl = wheel(-kHalfWheelbase, kHalfTrack);
    const Eigen::Vector3d rr = wheel(-kHalfWheelbase, -kHalfTrack);
    const Eigen::Vector3d forward = (fl + fr - rl - rr).normalized();
    const Eigen::Vector3d up = forward.cross(fl + rl - fr - rr).normalized();

    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear().col(0) = forward;
    pose.linear().col(1) = up.cross(forward);
    pose.linear().col(2) = up;
    pose.translation() =
        Eigen::Vector3d(plan.x, plan.y, (fl + fr + rl + rr).z() / 4) + kSensorHeight_m * up;
    return pose;
}
}  // namespace delio::synth
