#include "core/scan_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tangents.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using test::poseAt;

double difference(const Isometry3d& a, const Isometry3d& b) {
    return (a.matrix() - b.matrix()).norm() / (1 + b.translation().norm());
}

class MotionAt : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(CriticalAngles, MotionAt, testing::ValuesIn(test::criticalAngles()));

TEST_P(MotionAt, LeadsToTheIncrementInItsTimeAndBackInAsMuch) {
    for (const auto& twist : test::twistsOf(GetParam())) {
        const Isometry3d increment = poseExp(twist);
        for (const double duration_s : {0.01, 0.1, 3.0}) {
            const Twist motion = Twist::of(increment, duration_s);
            EXPECT_LT(difference(motion.after(duration_s), increment), 1e-12);
            EXPECT_LT(difference(motion.after(-duration_s), increment.inverse()), 1e-12);
            EXPECT_EQ(motion.after(0).matrix(), Isometry3d::Identity().matrix());
        }
    }
}

TEST_P(MotionAt, HalfTheTimeIsHalfTheWay) {
    for (const auto& twist : test::twistsOf(GetParam())) {
        const Isometry3d increment = poseExp(twist);
        const Isometry3d half = Twist::of(increment, 0.1).after(0.05);
        EXPECT_LT(difference(half * half, increment), 1e-12);
        EXPECT_NEAR(angleOf(half.linear()), GetParam() / 2, 1e-15);
    }
}

TEST_P(MotionAt, IsKnownAgainFromAnyPartOfIt) {
    Twist motion;
    motion.velocity << 12, -0.3, 0.1;
    motion.turning = GetParam() * Eigen::Vector3d(0.36, 0.48, 0.8);
    for (const double time_s : {0.03, 0.5, 1.0}) {
        const Twist again = Twist::of(motion.after(time_s), time_s);
        EXPECT_LT((again.velocity - motion.velocity).norm(), 1e-11);
        EXPECT_LT((again.turning - motion.turning).norm(), 1e-13);
    }
}

TEST(Twist, IsNoneByDefault) {
    EXPECT_EQ(Twist().after(5).matrix(), Isometry3d::Identity().matrix());
    EXPECT_EQ(Twist::of(Isometry3d::Identity(), 0.1).velocity.norm(), 0);
    EXPECT_EQ(Twist::of(Isometry3d::Identity(), 0.1).turning.norm(), 0);
}

TEST(Twist, AheadAndTurningIsACircle) {
    Twist motion;
    motion.velocity.x() = 15;
    motion.turning.z() = 0.6;
    const double radius = 15 / 0.6;
    for (const double time_s : {-1.0, 0.1, 0.7, 4.0}) {
        const double angle = 0.6 * time_s;
        EXPECT_LT(
            difference(motion.after(time_s),
                       poseAt(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, angle)),
            1e-14);
    }
}
}  // namespace
