#pragma once
#include <mrpt/core/Clock.h>

namespace delio::io {
/** The Unix time of `stamp_s` seconds after `epoch_s`. MRPT counts in 100 ns; rounding the sum of
 *  two doubles keeps times.txt's digits. */
mrpt::Clock::time_point timeOf(double stamp_s, double epoch_s = 0);

/** The inverse: the digits of times.txt come back. */
double secondsSince(double epoch_s, const mrpt::Clock::time_point& time);
}  // namespace delio::io
