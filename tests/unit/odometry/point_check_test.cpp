#include "odometry/paper_odometry.h"

#include <gtest/gtest.h>

#include "odometry_drive.h"

namespace {
using namespace delio;
using namespace delio::odometry;
using namespace delio::odometry_test;

const test::Sensor kSensor{16, 900, -15, 15, 0.02};

CheckPoints at(const Eigen::Isometry3d& pose, std::uint32_t seed, const test::Scene& scene) {
    test::Noise noise(seed);
    return checkPointsOf(test::ringScan(scene, pose, kSensor, noise).points,
                         Eigen::Matrix3f::Identity(), {}, {});
}

odometry::PointEstimate check(const test::Scene& before, const test::Scene& now,
                              const Eigen::Isometry3d& moved, const Eigen::Isometry3d& found) {
    const PointCheckOptions options;
    return checkByPoints(at(poseAtDeg(0, 0, 0, 0), 1, before), at(moved, 2, now), found,
                         Eigen::Isometry3d::Identity(), 4, options, {});
}

TEST(PointCheck, AStandstillOnAHighwayIsDenied) {
    for (const double metres : {2.2, 3.0, 3.7}) {
        const auto moved = poseAtDeg(metres, 0, 0, 0.3);
        const auto placed =
            check(test::highway(true), test::highway(true), moved, Eigen::Isometry3d::Identity());
        ASSERT_TRUE(placed.valid) << metres;
        expectPose(placed.pose, moved, 0.1, 0.5);
    }
}

// Patterns with few walls now and then fit elsewhere.
TEST(PointCheck, ARotationThatIsFarOffIsDenied) {
    const auto moved = poseAtDeg(2.2, 0, 0, 0.3);
    const auto placed =
        check(test::highway(true), test::highway(true), moved, moved * poseAtDeg(0.1, 0.5, 0, 10));
    ASSERT_TRUE(placed.valid);
    expectPose(placed.pose, moved, 0.1, 0.5);
}

TEST(PointCheck, WhatIsRightIsConfirmed) {
    const auto moved = poseAtDeg(2.2, 0, 0, 0.3);
    const auto placed = check(test::highway(true), test::highway(true), moved, moved);
    EXPECT_TRUE(!placed.valid || agree(placed.pose, moved, {})) << placed.pose.matrix();
}

TEST(PointCheck, WhereNothingTellsItDoesNot) {
    EXPECT_FALSE(check(test::highway(false), test::highway(false), poseAtDeg(2.2, 0, 0, 0),
                       Eigen::Isometry3d::Identity())
                     .valid);
    const CheckPoints nothing =
        checkPointsOf(Eigen::Matrix3Xf(3, 0), Eigen::Matrix3f::Identity(), {}, {});
    EXPECT_FALSE(checkByPoints(nothing, nothing, Eigen::Isometry3d::Identity(),
                               Eigen::Isometry3d::Identity(), 4, {}, {})
                     .valid);
}

// A vehicle that stands does not go with the cars that pass it.
TEST(PointCheck, StandingBetweenMovingCarsIsStanding) {
    auto before = test::highway(true), now = before;
    for (const double x : {-12.0, 3.0, 17.0}) {
        before.push_back({{x, 3, -1.6}, {x + 4.5, 4.8, 0}});
        now.push_back({{x + 2, 3, -1.6}, {x + 6.5, 4.8, 0}});
    }
    EXPECT_FALSE(
        check(before, now, Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()).valid);
}
}  // namespace
