#include "packet_clock.h"

#include <cmath>

namespace delio::io {
double PacketClock::between(double earlier_s, double later_s) const {
    const double passed_s = later_s - earlier_s;
    return period_s_ > 0 ? std::remainder(passed_s, period_s_) : passed_s;
}

double PacketClock::timeOf(double clock_s, double received_s) {
    constexpr double kSet_s = 30, kLeap_s = 0.5;
    if (!started_) {
        const double behind_s = between(received_s, clock_s);
        start_s_ = received_s + (std::abs(behind_s) < kSet_s && clock_s != 0 ? behind_s : 0);
    } else {
        const double recorded_s = received_s - received_s_, told_s = between(clock_s_, clock_s);
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
