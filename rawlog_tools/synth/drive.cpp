#include "drive.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kStep_m = 0.25;
constexpr double kMaxYawRate_rad_s = 0.48;
constexpr double kAcceleration_m_s2 = 1.7;
constexpr double kBraking_m_s2 = 2.0;

/** The speed at every kStep_m from s = 0: what curvature, brakes and engine allow. */
std::vector<double> speedProfile(const Path& path, double cruise) {
    std::vector<double> speed;
    for (double s = 0; s <= path.end(); s += kStep_m) {
        const double curvature = std::max(1e-6, std::abs(path.at(s).curvature));
        speed.push_back(std::min(cruise, kMaxYawRate_rad_s / curvature));
    }
    const auto limit = [](double& value, double neighbour, double acceleration) {
        value = std::min(value, std::sqrt(neighbour * neighbour + 2 * acceleration * kStep_m));
    };
    for (std::size_t i = speed.size() - 1; i-- > 0;) limit(speed[i], speed[i + 1], kBraking_m_s2);
    speed[0] = 0;
    for (std::size_t i = 1; i < speed.size(); ++i)
        limit(speed[i], speed[i - 1], kAcceleration_m_s2);
    return speed;
}
}  // namespace

Drive::Drive(const Road& road, std::size_t scans, std::uint64_t seed) : road_(road) {
    Random random{seed, 0xD71};
    const auto speed = speedProfile(road.path(), random.uniform(9, kMaxSpeed_m_s));
    double stepBegin_s = 0;
    for (std::size_t i = 0; i + 1 < speed.size() && s_.size() < scans; ++i) {
        const double duration = 2 * kStep_m / (speed[i] + speed[i + 1]);
        const double acceleration = (speed[i + 1] - speed[i]) / duration;
        while (s_.size() < scans) {
            const double t = kScanPeriod_s * static_cast<double>(s_.size()) - stepBegin_s;
            if (t >= duration) break;
            s_.push_back(kStep_m * static_cast<double>(i) + speed[i] * t +
                         acceleration * t * t / 2);
        }
        stepBegin_s += duration;
    }
}

Eigen::Isometry3d Drive::lidarPose(std::size_t scan) const {
    constexpr double kHalfWheelbase = 1.35, kHalfTrack = 0.75;
    const double s = s_[scan];
    const auto wheel = [&](double along, double side) {
        const double d = Road::kVehicleOffset_m + side;
        const Eigen::Vector2d place = road_.point(s + along, d);
        return Eigen::Vector3d(place.x(), place.y(), road_.height(place, d));
    };
    const Eigen::Vector3d fl = wheel(kHalfWheelbase, kHalfTrack);
    const Eigen::Vector3d fr = wheel(kHalfWheelbase, -kHalfTrack);
    const Eigen::Vector3d rl = wheel(-kHalfWheelbase, kHalfTrack);
    const Eigen::Vector3d rr = wheel(-kHalfWheelbase, -kHalfTrack);
    const Eigen::Vector3d forward = (fl + fr - rl - rr).normalized();
    const Eigen::Vector3d up = forward.cross(fl + rl - fr - rr).normalized();

    const Station at = road_.path().at(s);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear().col(0) = forward;
    pose.linear().col(1) = up.cross(forward);
    pose.linear().col(2) = up;
    pose.translation() =
        Eigen::Vector3d(at.x, at.y, (fl + fr + rl + rr).z() / 4) + kSensorHeight_m * up;
    return pose;
}
}  // namespace delio::synth
