#include "known_faults.h"

#include <algorithm>
#include <cmath>

namespace delio::evaluation {
namespace {
constexpr double kScans = 16, kTolerance_m = 0.005, kMany = 0.05;

bool isOfKitti00sHead(const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d step(-0.04686, -0.02836, 0.85819);  // the official poses' own, metres
    const Eigen::Vector3d position = pose.translation();
    const double scan = std::round(position.z() / step.z());
    return scan >= 1 && scan < kScans && (position - scan * step).norm() < kTolerance_m;
}
}  // namespace

std::string knownFaultOf(const std::vector<Eigen::Isometry3d>& reference) {
    const auto wrong = std::count_if(reference.begin(), reference.end(), isOfKitti00sHead);
    if (wrong < 2 || static_cast<double>(wrong) < kMany * static_cast<double>(reference.size()))
        return "";
    return std::to_string(wrong) + " of the " + std::to_string(reference.size()) +
           " true poses are KITTI's official ones of the first 16 scans of sequence 00, which are "
           "wrong: 12.9 m of path where odometries find 11.7 m. The errors say nothing about the "
           "estimate; take scans from 16 on, or another sequence";
}
}  // namespace delio::evaluation
