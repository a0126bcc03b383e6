#include "core/scan_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"
#include "tangents.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using test::poseAt;

double difference(const Isometry3d& a, const Isometry3d& b) {
    return (a.matrix() - b.matrix()).norm();
}

Twist bend() {
    Twist motion;
    motion.velocity << 8, -0.4, 0.2;
    motion.turning << 0.3, -0.8, 1.9;
    return motion;
}

ScanTrajectory uneven() {
    return {{-0.1, -0.02, 0.03, 0.05},
            {poseAt(3, 4, 5, 0.3), poseAt(3.5, 4, 5, 0.2, 0.1), poseAt(3.6, 4.1, 5, 0.5),
             poseAt(3.6, 4.1, 5, 0.6)}};
}

TEST(ScanTrajectory, LeadsThroughItsPoses) {
    const ScanTrajectory trajectory = uneven();
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(difference(trajectory.at(trajectory.times_s()[i]), trajectory.poses()[i]), 1e-12)
            << i;
}

TEST(ScanTrajectory, IsAtConstantTwistInBetweenAndBeyond) {
    const ScanTrajectory trajectory = uneven();
    const auto half = [&](double from_s, double to_s) {
        const Isometry3d there =
            trajectory.at(from_s).inverse() * trajectory.at((from_s + to_s) / 2);
        return difference(there * there, trajectory.at(from_s).inverse() * trajectory.at(to_s));
    };
    EXPECT_LT(half(-0.1, -0.02), 1e-12);
    EXPECT_LT(half(-0.02, 0.03), 1e-12);
    EXPECT_LT(half(-0.17, -0.03), 1e-12);
    EXPECT_LT(half(0.04, 0.3), 1e-12);
    EXPECT_GT(half(-0.1, 0.03), 1e-2);
}

TEST(ScanTrajectory, OfOneMotionIsThatMotion) {
    const ScanTrajectory always = bend(), parts = ScanTrajectory::even({-0.2, -0.1, 0.05},
                                                                       bend().after(-0.2), bend());
    for (const double time_s : {-0.5, -0.1, 0.0, 0.02, 0.7}) {
        EXPECT_LT(difference(always.at(time_s), bend().after(time_s)), 1e-12) << time_s;
        EXPECT_LT(difference(parts.at(time_s), bend().after(time_s)), 1e-12) << time_s;
    }
}

TEST(ScanTrajectory, IsTheSameSeenFromAnywhereOnIt) {
    const ScanTrajectory trajectory = uneven();
    for (const double from_s : {-0.1, 0.0, 0.2}) {
        const ScanTrajectory seen = trajectory.seenFrom(from_s);
        EXPECT_LT(difference(seen.at(0), Isometry3d::Identity()), 1e-12);
        for (const double time_s : {-0.15, -0.05, 0.04, 0.1})
            EXPECT_LT(
                difference(trajectory.at(from_s) * seen.at(time_s - from_s), trajectory.at(time_s)),
                1e-12);
    }
}

TEST(PoseTable, IsTheCourse) {
    const ScanTrajectory trajectory(Twist{{20, 0, 0}, {2, -3, 6}});  // 7 rad/s
    const PoseTable table(trajectory, -0.05, 0.05);
    for (double time_s = -0.05; time_s <= 0.05; time_s += 0.0007) {
        const Isometry3d off = trajectory.at(time_s).inverse() * table.at(time_s);
        EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 2e-6) << time_s;
        EXPECT_LT(off.translation().norm(), 3e-6) << time_s;  // 135 m/s2
    }
    EXPECT_LT(difference(table.at(0.05), trajectory.at(0.05)), 1e-12);
    EXPECT_LT(difference(PoseTable(trajectory, 0.01, 0.01).at(0.01), trajectory.at(0.01)), 1e-9);
}

TEST(PoseTable, OfFloatsIsTheCourse) {
    const ScanTrajectory trajectory(Twist{{20, 0, 0}, {2, -3, 6}});
    const PoseTable table(trajectory, -0.05, 0.05);
    const PoseTableOf<float> floats(trajectory, -0.05, 0.05);
    for (float time_s = -0.05F; time_s <= 0.05F; time_s += 0.0007F) {
        const Isometry3d exact = trajectory.at(time_s);
        const Eigen::Matrix4d off = floats.at(time_s).matrix().cast<double>() - exact.matrix();
        EXPECT_LT(off.norm(), 5e-6) << time_s;
        EXPECT_LT((table.placeAt(time_s) - exact.translation()).norm(), 3e-6) << time_s;
    }
}

TEST(ScanTrajectory, NeedsTwoPosesAtTimesThatIncrease) {
    const auto pose = Isometry3d::Identity();
    EXPECT_THROW(ScanTrajectory({}, {}), Error);
    EXPECT_THROW(ScanTrajectory({0}, {pose}), Error);
    EXPECT_THROW(ScanTrajectory({0, 1}, {pose}), Error);
    EXPECT_THROW(ScanTrajectory({0}, {pose, pose}), Error);
    EXPECT_THROW(ScanTrajectory({0, 0}, {pose, pose}), Error);
    EXPECT_THROW(ScanTrajectory({0, 1, 0.5}, {pose, pose, pose}), Error);
    EXPECT_THROW(ScanTrajectory({0, std::nan("")}, {pose, pose}), Error);
    EXPECT_NO_THROW(ScanTrajectory({0, 1}, {pose, pose}));
}
}  // namespace
