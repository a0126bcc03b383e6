#include "core/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace delio {
TEST(PortableMath, SinesAndCosinesAreTheCLibrarys) {
    std::mt19937 random(1);
    for (const double most : {1e-9, 1e-3, 1.0, 4.0, 1000.0}) {
        std::uniform_real_distribution<double> angles(-most, most);
        for (int i = 0; i < 10000; ++i) {
            const double angle = angles(random);
            EXPECT_NEAR(portable::sin(angle), std::sin(angle), 3e-16 * std::min(1.0, 2 * most));
            EXPECT_NEAR(portable::cos(angle), std::cos(angle), 3e-16);
        }
    }
    EXPECT_EQ(portable::sin(0), 0);
    EXPECT_EQ(portable::cos(0), 1);
}

TEST(PortableMath, AnglesAreTheCLibrarys) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> sizes(-200, 200), parts(-1, 1);
    for (int i = 0; i < 100000; ++i) {
        const double y = parts(random) * std::exp(sizes(random) / (i % 2 ? 1 : 100)),
                     x = parts(random) * std::exp(sizes(random) / (i % 2 ? 1 : 100));
        const double expected = std::atan2(y, x);
        EXPECT_NEAR(portable::atan2(y, x), expected, 5e-16 * std::abs(expected)) << y << ' ' << x;
    }
    for (const double y : {-2.0, 0.0, 2.0})
        for (const double x : {-2.0, 0.0, 2.0})
            EXPECT_NEAR(portable::atan2(y, x), std::atan2(y, x), 5e-16) << y << ' ' << x;
}

TEST(PortableMath, AKernelIsTheCLibrarys) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> numbers(-79, 0);
    for (int i = 0; i < 100000; ++i) {
        const float x = i % 2 ? numbers(random) : numbers(random) / 79;
        EXPECT_NEAR(portable::exp(x), std::exp(x), 1e-6F * std::exp(x)) << x;
    }
    EXPECT_EQ(portable::exp(0), 1);
    EXPECT_EQ(portable::exp(-81), 0);
    EXPECT_EQ(portable::exp(-1e30F), 0);
}
}  // namespace delio

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
