#pragma once
#include <chrono>
#include <type_traits>

namespace delio {
/** Stopwatch: milliseconds since construction or the last lap_ms(). */
class Stopwatch {
 public:
    /** Milliseconds since it was made, or since the last call. */
    double lap_ms() {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
        begin_ = now;
        return ms;
    }

 private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/** Runs `work`, adds its milliseconds to `ms`, and returns its result. */
template <typename Work>
auto timed(double& ms, const Work& work) {
    Stopwatch watch;
    if constexpr (std::is_void_v<decltype(work())>) {
        work();
        ms += watch.lap_ms();
    } else {
        auto result = work();
        ms += watch.lap_ms();
        return result;
    }
}
}  // namespace delio
