#include "velodyne_clock.h"

#include <cmath>

namespace delio::io {
double VelodyneClock::timeOf(std::uint32_t clock_us, double received_s) {
    constexpr double kHour_s = 3600, kSet_s = 30, kLeap_s = 0.5;
    const double clock_s = 1e-6 * static_cast<double>(clock_us);
    if (!started_) {
        const double behind_s = std::remainder(clock_s - received_s, kHour_s);
        start_s_ = received_s + (std::abs(behind_s) < kSet_s && clock_us != 0 ? behind_s : 0);
    } else {
        const double recorded_s = received_s - received_s_;
        const double told_s = std::remainder(clock_s - clock_s_, kHour_s);
        const bool agree = std::abs(told_s - recorded_s) < kLeap_s;
        const bool runs = clock_s != clock_s_ && (agree || (told_s > 0 && told_s < kLeap_s));
        since_s_ += runs ? told_s : recorded_s;
    }
    started_ = true;
    clock_s_ = clock_s;
    received_s_ = received_s;
    return start_s_ + since_s_;
}
}  // namespace delio::io
