#include "delio/odometry/adaptive_kernel.h"
#include "../core/portable_math.h"

#include <algorithm>
#include <cmath>

namespace delio {
void AdaptiveKernel::observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted) {
    // An error of the rotation moves points at this distance by as much.
    constexpr double kTypicalRange_m = 20;
    constexpr std::size_t kMemory = 20;
    const Eigen::Isometry3d off = predicted.inverse() * found;
    const double angle = angleOf(off.linear());
    errors_m_.push_back(off.translation().norm() +
                        2 * kTypicalRange_m * portable::sin(std::abs(angle) / 2));
    if (errors_m_.size() > kMemory) errors_m_.pop_front();
}

bool AdaptiveKernel::isKnown() const {
    constexpr std::size_t kEnough = 3;
    return errors_m_.size() >= kEnough;
}

double AdaptiveKernel::width(double least, double most) const {
    if (!isKnown()) return most;
    double squares = 0;
    for (const double error : errors_m_) squares += error * error;
    const double sigma = std::sqrt(squares / static_cast<double>(errors_m_.size()));
    return std::clamp(3 * sigma, least, most);
}
}  // namespace delio
