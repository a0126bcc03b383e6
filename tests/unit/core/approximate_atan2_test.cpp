#include "core/portable_math.h"

#include <gtest/gtest.h>

#include <limits>

namespace {
using delio::approximateAtan2;

TEST(ApproximateAtan2, IsAsNearAsItSaysAllAround) {
    constexpr double kClaimed = 4e-6;
    double worst = 0;
    for (int i = -36000; i <= 36000; ++i)
        for (const double length : {1e-3, 1.0, 120.0}) {
            const double angle = i * M_PI / 36000;
            const auto x = static_cast<float>(length * std::cos(angle)),
                       y = static_cast<float>(length * std::sin(angle));
            const double exact = std::atan2(double{y}, double{x});
            worst = std::max(worst, std::abs(double{approximateAtan2(y, x)} - exact));
        }
    EXPECT_LT(worst, kClaimed);
    EXPECT_GT(worst, 0) << "as exact as that it would not be faster";
}

TEST(ApproximateAtan2, TakesTheAxesAndTheirSigns) {
    constexpr double kClaimed = 4e-6;
    for (const float x : {-2.F, -0.F, 0.F, 2.F})
        for (const float y : {-3.F, -0.F, 0.F, 3.F}) {
            if (x == 0 && y == 0) continue;
            EXPECT_NEAR(approximateAtan2(y, x), std::atan2(y, x), kClaimed) << y << ", " << x;
        }
    EXPECT_EQ(approximateAtan2(0, 0), 0);
    const float least = std::numeric_limits<float>::denorm_min();
    EXPECT_NEAR(approximateAtan2(least, least), M_PI_4, kClaimed);
}
}  // namespace
