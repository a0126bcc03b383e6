#include "handheld.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;
constexpr std::uint64_t kSwingKey = 0x4A2D;
constexpr double kSlowestWalk_m_s = 1.0;
constexpr double kStep_Hz = 1.9;  // a walker bobs once a step, and sways once every two
}  // namespace

DrivingStyle walking(DrivingStyle style) {
    style.fastest_m_s = std::min(style.fastest_m_s, kFastestWalk_m_s);
    style.slowest_m_s = std::min(style.slowest_m_s, kSlowestWalk_m_s);
    return style;
}

double Handheld::Sine::at(double time_s) const {
    return amplitude * std::sin(2 * kPi * frequency_Hz * time_s + phase);
}

Handheld::Sine Handheld::sine(double amplitude, double frequency_Hz, std::uint64_t seed,
                              std::uint64_t axis) {
    Random random{seed, kSwingKey, axis};
    return {amplitude * random.uniform(0.9, 1.1), frequency_Hz * random.uniform(0.95, 1.05),
            random.uniform(0, 2 * kPi)};
}

Handheld::Handheld(std::uint64_t seed) {
    for (std::size_t i = 0; i < 3; ++i) turns_[i] = sine(kSwing_deg * kDegree, kSwing_Hz, seed, i);
    shifts_ = {sine(0.02, kStep_Hz, seed, 3), sine(0.03, kStep_Hz / 2, seed, 4),
               sine(0.03, kStep_Hz, seed, 5)};
}

Eigen::Isometry3d Handheld::at(double time_s) const {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    return Eigen::Translation3d(shifts_[0].at(time_s), shifts_[1].at(time_s),
                                shifts_[2].at(time_s)) *
           AngleAxisd(turns_[0].at(time_s), Vector3d::UnitZ()) *
           AngleAxisd(turns_[1].at(time_s), Vector3d::UnitY()) *
           AngleAxisd(turns_[2].at(time_s), Vector3d::UnitX());
}
}  // namespace delio::synth
