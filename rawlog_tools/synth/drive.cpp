#include "drive.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pose_on_road.h"
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
    const double end_s = kScanPeriod_s * static_cast<double>(scans);  // what the last sweep needs
    double time_s = 0;
    for (std::size_t i = 0; i + 1 < speed.size() && time_s <= end_s; ++i) {
        const double duration = 2 * kStep_m / (speed[i] + speed[i + 1]);
        legs_.push_back({time_s, kStep_m * static_cast<double>(i), speed[i],
                         (speed[i + 1] - speed[i]) / duration});
        time_s += duration;
    }
    for (std::size_t i = 0; i < scans; ++i)
        s_.push_back(stationAt(kScanPeriod_s * static_cast<double>(i)));
}

double Drive::stationAt(double time_s) const {
    if (time_s <= 0) return 0;
    const auto next = std::upper_bound(legs_.begin(), legs_.end(), time_s,
                                       [](double t, const Leg& leg) { return t < leg.begin_s; });
    const Leg& leg = *std::prev(next);
    const double t = time_s - leg.begin_s;
    return leg.station + leg.speed * t + leg.acceleration * t * t / 2;
}

Eigen::Isometry3d Drive::lidarPose(std::size_t scan) const {
    return lidarPoseAt(kScanPeriod_s * static_cast<double>(scan));
}

Eigen::Isometry3d Drive::lidarPoseAt(double time_s) const {
    const double s = stationAt(time_s);
    return poseOnRoad(road_, s, Road::kVehicleOffset_m, {1.35, 0.75}) *
           Eigen::Translation3d(0, 0, kSensorHeight_m);
}
}  // namespace delio::synth
