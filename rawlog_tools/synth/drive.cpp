#include "drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "back.h"
#include "speed_profile.h"

namespace delio::synth {
Drive::Drive(const Road& road, std::size_t scans, std::uint64_t seed, Gait gait, Start start)
    : road_(road), carrier_(road.profile().carrier), motion_(road.givenMotion()) {
    DrivingStyle style = road.profile().style;
    if (gait == Gait::kHandheld) {
        hand_.emplace(seed);
        carrier_ = onFoot();
        style = walking(style);
    }
    if (!motion_) {
        own_ = begun(std::make_shared<SpeedProfile>(road.path(), style, seed), start);
        motion_ = own_.get();
    }
    const double known = std::floor(motion_->duration_s() / kScanPeriod_s + 1e-6);
    scans_ = std::min(scans, static_cast<std::size_t>(known) + 1);
}

void Drive::turnBack() {
    if (!own_) own_ = {std::shared_ptr<const void>(), motion_};  // the road's, which lives longer
    own_ = drivenBack(std::move(own_), timeOf(scans_ - 1), -2 * road_.vehicleSide());
    motion_ = own_.get();
}

Eigen::Isometry3d Drive::lidarPoseAt(double time_s) const {
    const Eigen::Isometry3d steady = steadyPoseAt(time_s);
    return hand_ ? steady * hand_->at(time_s) : steady;
}

Eigen::Isometry3d Drive::steadyPoseAt(double time_s) const {
    const auto [halfLength, halfWidth] = carrier_.footprint;
    const PlanPose plan = motion_->at(time_s);
    const Eigen::Vector2d ahead(std::cos(plan.yaw), std::sin(plan.yaw));
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    const auto wheel = [&](double along, double side) {
        const Eigen::Vector2d place = Eigen::Vector2d(plan.x, plan.y) + along * ahead + side * left;
        return Eigen::Vector3d(place.x(), place.y(), road_.height(place));
    };
    const Eigen::Vector3d fl = wheel(halfLength, halfWidth);
    const Eigen::Vector3d fr = wheel(halfLength, -halfWidth);
    const Eigen::Vector3d rl = wheel(-halfLength, halfWidth);
    const Eigen::Vector3d rr = wheel(-halfLength, -halfWidth);
    Eigen::Vector3d forward = (fl + fr - rl - rr).normalized();
    Eigen::Vector3d up = forward.cross(fl + rl - fr - rr).normalized();
    if (!carrier_.isVehicle) {
        forward << ahead, 0;
        up = Eigen::Vector3d::UnitZ();
    }

    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear().col(0) = forward;
    pose.linear().col(1) = up.cross(forward);
    pose.linear().col(2) = up;
    pose.translation() =
        Eigen::Vector3d(plan.x, plan.y, (fl + fr + rl + rr).z() / 4) + carrier_.sensorHeight_m * up;
    return pose;
}
}  // namespace delio::synth
