#include "echo.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
double detectionProbability(const Hit& hit) {
    // The echo's strength, 1 for a white wall at 100 m: road is lost from 50 m on, as in real
    // scans. Panes and dark paint mirror most of the light away unless hit head-on.
    const double mirror = hit.reflectivity < 0.1 ? std::pow(hit.cosIncidence, 4) : 1;
    const double strength =
        hit.reflectivity * hit.cosIncidence * (100 / hit.range) * (100 / hit.range);
    return mirror * (1 - std::exp(-strength / 0.04));
}

float intensity(const Hit& hit, double gain, Random& random) {
    // The instrument makes up for the distance as far as its gain reaches, some 20 m.
    const double reach = std::clamp(1.35 - hit.range / 45, 0.0, 1.0);
    const double value =
        gain * reach * hit.reflectivity * (0.8 + 0.4 * hit.cosIncidence) + 0.03 * random.normal();
    return static_cast<float>(std::round(100 * std::clamp(value, 0.0, 0.99)) / 100);
}

double mixedShare(const Hit& hit, const Hit& next, Random& random) {
    constexpr double kNearest_m = 0.2, kPulse_m = 1.5, kProbability = 0.2;
    const double apart = std::abs(next.range - hit.range);
    const bool draw = random.chance(kProbability);  // always drawn: the stream stays in step
    const double share = random.uniform();
    return draw && next.range > 0 && apart > kNearest_m && apart < kPulse_m ? share : 0;
}
}  // namespace delio::synth
