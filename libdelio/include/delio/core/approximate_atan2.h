#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

namespace delio {
/** atan2 to within 4e-6 rad, faster, and the same for a build on whichever processor it runs (the C
 *  library takes its own for each). Of (0, 0): 0. */
inline float approximateAtan2(float y, float x) {
    constexpr float kQuarter = 1.5707963F;
    const float most = std::max(std::abs(x), std::abs(y)),
                least = std::min(std::abs(x), std::abs(y));
    constexpr float kLeast = std::numeric_limits<float>::denorm_min();  // in place of a branch
    const float t = least / std::max(most, kLeast), s = t * t;
    // Chebyshev fit of atan(t) / t over s in [0, 1].
    const float eighth =
        t * (0.99999553F +
             s * (-0.33298874F +
                  s * (0.19558951F + s * (-0.1211103F + s * (0.057331175F + s * -0.01342233F)))));
    const float quarter = std::abs(y) > std::abs(x) ? kQuarter - eighth : eighth;
    return std::copysign(x < 0 ? 2 * kQuarter - quarter : quarter, y);
}
}  // namespace delio
