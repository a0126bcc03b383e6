#include "odometry/register_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ring_scan.h"
#include "swing.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using odometry::TimedPoints;
using odometry::TrajectoryPrior;
using test::degreesBetween;
using test::poseAt;
using test::swung;

constexpr double kSince_s = 0.1;

odometry::PlaneMap mapOf(const test::Scene& scene) {
    test::Noise noise;
    odometry::PlaneMap map{PlaneMapOptions{}};
    for (int i = 0; i < 8; ++i) {
        const Isometry3d pose = poseAt(0.2 * i - 1, 0.1, 0, 0.3 * i, 0.02 * i, 0.01 * i);
        const Eigen::Matrix3Xd points =
            test::ringScan(scene, pose, {32, 720, -24, 8, 0.01}, noise).points.cast<double>();
        map.add((pose.linear() * points).colwise() + pose.translation());
    }
    return map;
}

/** At one twist, from the true pose before to a pose that is off at the stamp. */
ScanTrajectory constantTwist(const Isometry3d& off) {
    const Isometry3d start = swung(-kSince_s);
    return ScanTrajectory::even({-0.1, -0.05, -0.025, 0, 0.025, 0.05}, start,
                                Twist::of(start.inverse() * swung(0) * off, kSince_s));
}

struct Off {
    double metres = 0, degrees = 0;
};
Off worstOf(const ScanTrajectory& trajectory) {
    Off worst;
    for (double time_s = -0.05; time_s <= 0.05; time_s += 0.005) {
        worst.metres =
            std::max(worst.metres,
                     (trajectory.at(time_s).translation() - swung(time_s).translation()).norm());
        worst.degrees =
            std::max(worst.degrees, degreesBetween(trajectory.at(time_s), swung(time_s)));
    }
    return worst;
}

const TrajectoryPrior kOfHand{0.05, 0.02, 0.1, 0.1};

TEST(CourseRegistration, FindsTheSwingWithinAScan) {
    const auto map = mapOf(test::yard());
    const auto scan = test::sweep(test::yard(), 0.01);
    for (const auto& off : {poseAt(0, 0, 0), poseAt(0.04, -0.03, 0.02, 0.01, -0.01, 0.005)}) {
        const ScanTrajectory even = constantTwist(off);
        EXPECT_GT(worstOf(even).degrees, 1);
        const Off worst =
            worstOf(odometry::registerTrajectory(map, scan, even, kSince_s, kOfHand, 1, {}));
        EXPECT_LT(worst.metres, 0.02);
        EXPECT_LT(worst.degrees, 0.12);
    }
}

TEST(CourseRegistration, StartsWhereItIsKnownToStart) {
    const auto found =
        odometry::registerTrajectory(mapOf(test::yard()), test::sweep(test::yard(), 0),
                                     constantTwist(poseAt(0, 0, 0)), kSince_s, kOfHand, 1, {});
    EXPECT_LT((found.at(-kSince_s).matrix() - swung(-kSince_s).matrix()).norm(), 1e-12);
}

// In a corridor only the noise of normals tells how far it went along it: not farther than what is
// known before allows.
TEST(CourseRegistration, IsLedAstrayNoFartherThanIsLikely) {
    constexpr double kSigma_m = 0.01;
    const ScanTrajectory even = constantTwist(poseAt(0, 0, 0));
    const auto found =
        odometry::registerTrajectory(mapOf(test::corridor()), test::sweep(test::corridor(), 0),
                                     even, kSince_s, {kSigma_m, 0.02, kSigma_m, 0.1}, 1, {});
    for (const double time_s : {-0.05, 0.0, 0.05})
        EXPECT_NEAR(found.at(time_s).translation().x(), even.at(time_s).translation().x(),
                    3 * kSigma_m);
    EXPECT_LT(worstOf(found).degrees, 0.2);
}

TEST(CourseRegistration, AnEvenMotionStaysEvenWhereItIsKnownToBe) {
    const ScanTrajectory even = constantTwist(poseAt(0, 0, 0));
    const auto found =
        odometry::registerTrajectory(mapOf(test::yard()), test::sweep(test::yard(), 0.01), even,
                                     kSince_s, {1e-4, 1e-4, 1e-5, 1e-5}, 1, {});
    for (const double time_s : {-0.05, 0.0, 0.05})
        EXPECT_LT((found.at(time_s).matrix() - even.at(time_s).matrix()).norm(), 1e-2);
}

TEST(CourseRegistration, WithTooFewPointsTheCourseStays) {
    const ScanTrajectory even = constantTwist(poseAt(0, 0, 0));
    const TimedPoints none{Eigen::Matrix3Xd(3, 0), {}},
        far{Eigen::Matrix3Xd::Constant(3, 500, 900), std::vector<double>(500, 0.01)};
    for (const auto& scan : {none, far}) {
        const auto found =
            odometry::registerTrajectory(mapOf(test::yard()), scan, even, kSince_s, kOfHand, 1, {});
        EXPECT_EQ(found.at(0.03).matrix(), even.at(0.03).matrix());
    }
}

}  // namespace
