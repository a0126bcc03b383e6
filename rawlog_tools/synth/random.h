#pragma once
#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace delio::synth {
/** A stream of random numbers that depends on its keys alone (seed, tile, scan, ray ...), so that
 *  what is drawn for one thing does not depend on what was drawn before, or by which thread.
 *  (SplitMix64; the distributions of <random> differ between libraries.) */
class Random {
 public:
    Random(std::initializer_list<std::uint64_t> keys) {
        for (const auto key : keys) state_ = mix(state_ + kStep + key);
    }

    std::uint64_t next() { return mix(state_ += kStep); }

    /** In [0, 1). */
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    bool chance(double probability) { return uniform() < probability; }

    /** Standard normal (Box-Muller; 1 - u keeps the logarithm finite). */
    double normal() {
        const double radius = std::sqrt(-2 * std::log(1 - uniform()));
        return radius * std::cos(2 * 3.14159265358979323846 * uniform());
    }

 private:
    static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;
    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
        return z ^ (z >> 31);
    }
    std::uint64_t state_ = 0;
};
}  // namespace delio::synth
