#include "scene_support.h"

#include <algorithm>
#include <cmath>

#include "delio/core/geometry.h"
#include "delio/formats/trajectory.h"
#include "poses.h"
#include "random.h"
#include "test_data.h"

namespace delio::test {
Eigen::Isometry3d kittiAxes() {
    Eigen::Matrix3d R;
    R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    return isometry(R, Eigen::Vector3d::Zero());
}

std::unique_ptr<synth::Scene> sceneOf(const std::string& name, std::uint64_t seed,
                                      std::size_t scans, const std::string& trajectory) {
    return synth::makeScene({name, seed, scans, trajectory, kittiAxes()});
}

void writeEight(const std::filesystem::path& file, double jitter_m) {
    // Two circles that touch, the left one first; both are driven through their common point in
    // the same direction.
    constexpr double kPi = 3.14159265358979323846, kCruise_m_s = 8, kBraking_m_s2 = 2;
    constexpr double kPeriod_s = 0.1;
    const double round = 2 * kPi * kEightRadius_m, stop = 1.3 * round;
    io::Trajectory poses;
    synth::Random random{1, 2};
    double speed = kCruise_m_s;
    int standing = 0;
    for (double s = 0; s < 4 * round; s += speed * kPeriod_s) {
        const double way = std::fmod(s, 2 * round);
        const double side = way < round ? 1 : -1;
        const double angle = std::fmod(way, round) / kEightRadius_m;
        const double x = kEightRadius_m * std::sin(angle) + jitter_m * random.normal();
        const double y = side * kEightRadius_m * (1 - std::cos(angle)) + jitter_m * random.normal();
        poses.poses.push_back(poseAt(x, y, 0.02 * x, side * angle));
        const bool brakes = standing == 0 && stop - s < speed * speed / (2 * kBraking_m_s2);
        if (brakes)
            speed = std::max(0.0, speed - kBraking_m_s2 * kPeriod_s);
        else if (standing > 0 && standing < 30)
            ++standing;
        else
            speed = std::min(kCruise_m_s, speed + kBraking_m_s2 * kPeriod_s);
        if (speed == 0 && standing == 0) standing = 1;
    }
    writeText(file, "");
    io::writeKitti(io::lidarToCam0(poses, kittiAxes()), file.string());
}
}  // namespace delio::test
