#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

/** Functions with one result on every processor, to within some bits. The C library has others
 * where there are fused multiply-adds, whose last digit differs now and then. */
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

namespace delio::portable {
struct SineAndCosine {
    double sine, cosine;
};

/** For angles of less than a million quarter turns. */
inline SineAndCosine sineAndCosine(double angle) {
    // A quarter turn in three parts: the first two have 33 digits, so that their multiples are
    // exact.
    constexpr double kFirst = 0x1.921fb544p+0, kSecond = 0x1.0b4611a6p-34, kThird = 0x1.3198a2ep-69;
    const auto quarters = static_cast<int>(std::lrint(angle / kFirst));
    const double x = ((angle - quarters * kFirst) - quarters * kSecond) - quarters * kThird,
                 s = x * x;
    // Taylor's series, |x| <= pi / 4.
    const double sine =
        x *
        (1 - s * (1. / 6) *
                 (1 - s * (1. / 20) *
                          (1 - s * (1. / 42) *
                                   (1 - s * (1. / 72) *
                                            (1 - s * (1. / 110) *
                                                     (1 - s * (1. / 156) *
                                                              (1 - s * (1. / 210) *
                                                                       (1 - s * (1. / 272)))))))));
    const double cosine =
        1 - s * (1. / 2) *
                (1 - s * (1. / 12) *
                         (1 - s * (1. / 30) *
                                  (1 - s * (1. / 56) *
                                           (1 - s * (1. / 90) *
                                                    (1 - s * (1. / 132) *
                                                             (1 - s * (1. / 182) *
                                                                      (1 - s * (1. / 240))))))));
    switch (quarters & 3) {
        case 1:
            return {cosine, -sine};
        case 2:
            return {-sine, -cosine};
        case 3:
            return {-cosine, sine};
        default:
            return {sine, cosine};
    }
}
inline double sin(double angle) { return sineAndCosine(angle).sine; }
inline double cos(double angle) { return sineAndCosine(angle).cosine; }

/** From -pi to pi; of (0, 0): 0. */
inline double atan2(double y, double x) {
    // Half of pi, and what is left of it behind its digits.
    constexpr double kQuarter = 0x1.921fb54442d18p+0, kRest = 0x1.1a62633145c07p-54;
    const double ahead = std::abs(x), up = std::abs(y), most = std::max(ahead, up);
    if (!(most > 0)) return 0;
    // Turned back by nearly its angle, the vector (1, slope) has what is left of it as its slope.
    const double slope = std::min(ahead, up) / most;
    const auto nearly = double{approximateAtan2(static_cast<float>(slope), 1.0F)};
    const auto turned = sineAndCosine(nearly);
    const double left =
        (slope * turned.cosine - turned.sine) / (turned.cosine + slope * turned.sine);
    const double eighth = nearly + left * (1 - left * left / 3);
    const double quarter = up > ahead ? kQuarter - (eighth - kRest) : eighth;
    return std::copysign(x < 0 ? 2 * kQuarter - (quarter - 2 * kRest) : quarter, y);
}

/** A kernel's exp(x), x <= 0: of floats; 0 below -80. */
inline float exp(float x) {
    if (!(x > -80)) return 0;
    // exp(x) = 2^power exp(rest), |rest| <= ln(2) / 2, of which the series is summed.
    constexpr float kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F;
    const auto power = static_cast<std::int32_t>(x * 1.442695041F - 0.5F);
    const auto whole = static_cast<float>(power);
    const float rest = (x - whole * kLn2High) - whole * kLn2Low;
    const float sum =
        1 + rest * (1 + rest * (1.F / 2) *
                            (1 + rest * (1.F / 3) *
                                     (1 + rest * (1.F / 4) *
                                              (1 + rest * (1.F / 5) * (1 + rest * (1.F / 6))))));
    const std::int32_t bits = (127 + power) << 23;
    float scale = 0;
    std::memcpy(&scale, &bits, sizeof(scale));
    return sum * scale;
}
}  // namespace delio::portable
