#include "odometry/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "poses.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using test::poseAt;

/** After predictions that were off by so many metres each. */
AdaptiveKernel after(const std::vector<double>& errors_m) {
    AdaptiveKernel kernel;
    for (const double error : errors_m) kernel.observe(poseAt(0, error, 0), poseAt(0, 0, 0));
    return kernel;
}

TEST(AdaptiveKernel, IsTheFirstOneUntilThreePredictionsAreKnown) {
    for (const auto& errors : {std::vector<double>{}, {0.1}, {0.1, 0.1}})
        EXPECT_EQ(after(errors).width(0.02, 100), 100);
    EXPECT_NE(after({0.1, 0.1, 0.1}).width(0.02, 100), 100);
}

TEST(AdaptiveKernel, IsThreeTimesTheRootMeanSquare) {
    EXPECT_NEAR(after({0.1, 0.1, 0.1}).width(0.02, 100), 0.3, 1e-12);
    EXPECT_NEAR(after({0.1, 0.1, 0.2}).width(0.02, 100), 3 * std::sqrt(0.06 / 3), 1e-12);
    EXPECT_NEAR(after({0, 0, 0, 0.5}).width(0.02, 100), 0.75, 1e-12);
}

TEST(AdaptiveKernel, ATurnCountsAsWhatItMovesAtTwentyMetres) {
    const auto widthOf = [](const Isometry3d& off) {
        AdaptiveKernel kernel;
        const Isometry3d predicted = poseAt(100, -20, 3, 2, 0.1, -0.2);  // wherever that is
        for (int i = 0; i < 3; ++i) kernel.observe(predicted * off, predicted);
        return kernel.width(0.02, 100);
    };
    for (const double angle : {0.01, -0.2, 1.0}) {
        const double chord = 2 * 20 * std::sin(std::abs(angle) / 2);
        EXPECT_NEAR(widthOf(poseAt(0, 0, 0, angle)), 3 * chord, 1e-9);
        EXPECT_NEAR(widthOf(poseAt(0.03, 0.04, 0, 0, 0, angle)), 3 * (0.05 + chord), 1e-9);
    }
}

TEST(AdaptiveKernel, StaysWithinItsLimits) {
    EXPECT_EQ(after({0, 0, 0}).width(0.2, 1), 0.2);
    EXPECT_EQ(after({5, 5, 5}).width(0.2, 1), 1);
    EXPECT_NEAR(after({0.2, 0.2, 0.2}).width(0.2, 1), 0.6, 1e-12);
    EXPECT_EQ(after({0.2, 0.2, 0.2}).width(1, 1), 1);
}

TEST(AdaptiveKernel, RemembersTwentyPredictions) {
    std::vector<double> errors(20, 0.1);
    errors.insert(errors.begin(), 7);
    EXPECT_NEAR(after(errors).width(0.02, 100), 0.3, 1e-12);
    errors.pop_back();
    EXPECT_NEAR(after(errors).width(0.02, 100), 3 * std::sqrt((49 + 19 * 0.01) / 20), 1e-12);
}
}  // namespace
