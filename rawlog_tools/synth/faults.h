#pragma once
#include <cstddef>
#include <cstdint>

namespace delio::synth {
/** Faults between a sensor and its recording. */
enum class Fault {
    kNone,
    kDropped,   //!< nothing arrived
    kRepeated,  //!< the data of the scan before came again, under the stamp of this one
    kEmpty      //!< a scan without points
};
const char* nameOf(Fault fault);

/** Probabilities, each in [0, 1), and scans in a row that are dropped. */
struct FaultRates {
    double drop = 0, repeat = 0, empty = 0;
    std::size_t gapFirst = 0, gapScans = 0;
};

/** Depends on seed and scan alone. A scan that is dropped is neither repeated nor empty, one that
 * is repeated is not empty. The first scan of a drive never fails: there is nothing to repeat, and
 *  the truth counts from it. */
Fault faultOf(const FaultRates& rates, std::size_t scan, std::uint64_t seed);
}  // namespace delio::synth
