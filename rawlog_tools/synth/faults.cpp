#include "faults.h"

#include "random.h"

namespace delio::synth {
namespace {
constexpr std::uint64_t kFaultKey = 0xFA17;
}

const char* nameOf(Fault fault) {
    switch (fault) {
        case Fault::kDropped:
            return "dropped";
        case Fault::kRepeated:
            return "repeated";
        case Fault::kEmpty:
            return "empty";
        case Fault::kNone:
            break;
    }
    return "none";
}

Fault faultOf(const FaultRates& rates, std::size_t scan, std::uint64_t seed) {
    if (scan == 0) return Fault::kNone;
    // A draw for each: raising one rate leaves the scans that another one hits as they are.
    Random random{seed, kFaultKey, scan};
    const bool drop = random.chance(rates.drop), repeat = random.chance(rates.repeat),
               empty = random.chance(rates.empty);
    const bool isInGap = scan >= rates.gapFirst && scan - rates.gapFirst < rates.gapScans;
    if (drop || isInGap) return Fault::kDropped;
    if (repeat) return Fault::kRepeated;
    return empty ? Fault::kEmpty : Fault::kNone;
}
}  // namespace delio::synth
