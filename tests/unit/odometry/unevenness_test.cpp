#include "odometry/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "poses.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using test::poseAt;

/** After so many increments that were off by `metres` and `radians`. */
odometry::TrajectoryPrior after(int count, double metres, double radians, double most = 1) {
    Unevenness unevenness;
    for (int i = 0; i < count; ++i)
        unevenness.observe(poseAt(2, 0, 0, 0.1) * poseAt(0, metres, 0, 0, radians),
                           poseAt(2, 0, 0, 0.1));
    return unevenness.prior(most);
}

TEST(Unevenness, IsTheRootMeanSquareAnAxis) {
    for (const int count : {3, 20, 50}) {
        EXPECT_NEAR(after(count, 0.3, 0.2).unevenTranslation, 0.3 / std::sqrt(3), 1e-9);
        EXPECT_NEAR(after(count, 0.3, 0.2).unevenRotation, 0.2 / std::sqrt(3), 1e-9);
    }
}

TEST(Unevenness, MayBeAHandsWhileLittleIsKnown) {
    const double unknown_rad = after(0, 0, 0).unevenRotation;
    EXPECT_NEAR(unknown_rad, 3 * M_PI / 180, 1e-9);
    EXPECT_NEAR(after(1, 0, 0).unevenRotation, unknown_rad / std::sqrt(2), 1e-9);
    EXPECT_NEAR(after(2, 0, 0).unevenRotation, unknown_rad / std::sqrt(3), 1e-9);
    EXPECT_LT(after(3, 0, 0).unevenRotation, 1e-4);
}

TEST(Unevenness, StaysWithinLimits) {
    EXPECT_EQ(after(5, 0.3, 0, 0.05).unevenTranslation, 0.05);
    EXPECT_GT(after(5, 0, 0).unevenTranslation, 0);
    EXPECT_GT(after(5, 0, 0).unevenRotation, 0);
}

TEST(Unevenness, ForgetsWhatWasLongAgo) {
    Unevenness unevenness;
    for (int i = 0; i < 40; ++i)
        unevenness.observe(poseAt(0, 0, 0, i < 20 ? 0.5 : 0.01), poseAt(0, 0, 0));
    EXPECT_NEAR(unevenness.prior(1).unevenRotation, 0.01 / std::sqrt(3), 1e-9);
}
// Two scans a millisecond apart, or [plane_tracker] acceleration=0.
TEST(Unevenness, ALimitBelowTheLeastIsTheLeast) {
    Unevenness unevenness;
    unevenness.observe(poseAt(0.1, 0, 0), poseAt(0, 0, 0));
    EXPECT_GT(unevenness.prior(0).unevenTranslation, 0);
    EXPECT_EQ(unevenness.prior(0).unevenTranslation, unevenness.prior(1e-6).unevenTranslation);
}
}  // namespace
