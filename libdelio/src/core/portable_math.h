#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "delio/core/approximate_atan2.h"

/** Functions with one result on every processor, to within some bits. The C library has others
 * where there are fused multiply-adds, whose last digit differs now and then. */
namespace delio::portable {
struct SineAndCosine {
    double sine, cosine;
};

/** Of angles whose number of quarter turns is an int. */
inline SineAndCosine sineAndCosine(double angle) {
    // What is left of whole quarter turns, in two parts that are as good as twice the digits.
    constexpr double kQuarter = 0x1.921fb54442d18p+0, kRest = 0x1.1a62633145c07p-54;
    const auto quarters = static_cast<int>(std::lrint(angle / kQuarter));
    const double x = (angle - quarters * kQuarter) - quarters * kRest, s = x * x;
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
    const double most = std::max(std::abs(x), std::abs(y));
    if (!(most > 0)) return 0;
    const double up = y / most, ahead = x / most;
    // The vector, turned back by nearly its angle, has what is left of it as its slope.
    const auto nearly = double{approximateAtan2(static_cast<float>(up), static_cast<float>(ahead))};
    const auto turned = sineAndCosine(nearly);
    const double slope =
        (up * turned.cosine - ahead * turned.sine) / (ahead * turned.cosine + up * turned.sine);
    return nearly + slope * (1 - slope * slope / 3);
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
