#include "clock.h"

#include <cmath>

namespace delio::io {
mrpt::Clock::time_point timeOf(double stamp_s, double epoch_s) {
    const double wholeEpoch = std::floor(epoch_s);
    const auto fraction = std::llround((stamp_s + (epoch_s - wholeEpoch)) * 1e7);
    return mrpt::Clock::fromDouble(wholeEpoch) + mrpt::Clock::duration(fraction);
}

double secondsSince(double epoch_s, const mrpt::Clock::time_point& time) {
    const double wholeEpoch = std::floor(epoch_s);
    const auto ticks = (time - mrpt::Clock::fromDouble(wholeEpoch)).count();
    return static_cast<double>(ticks) / 1e7 - (epoch_s - wholeEpoch);
}
}  // namespace delio::io
