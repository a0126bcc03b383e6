#include "delio/evaluation/kitti_metric.h"

#include <gtest/gtest.h>
#include <mrpt/core/bits_math.h>

#include <cmath>

#include "poses.h"

namespace {
using namespace delio::evaluation;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

// Steps that sum up without rounding: a segment of L metres ends at L + kStep_m exactly.
constexpr double kStep_m = 0.5;

/** A drive of `count` poses with the same motion between any two. */
Poses chain(const Eigen::Isometry3d& motion, std::size_t count) {
    Poses poses = {Eigen::Isometry3d::Identity()};
    while (poses.size() < count) poses.push_back(poses.back() * motion);
    return poses;
}

Poses straight(double step_m, std::size_t count) { return chain(poseAt(0, 0, step_m), count); }

TEST(KittiMetric, IdenticalTrajectoriesHaveNoError) {
    const auto drive = chain(poseAt(0.02, 0.01, 1.1, 0.01, -0.002, 0.3), 900);
    const auto errors = kittiErrors(drive, drive);
    EXPECT_GT(errors.segments, 100U);
    EXPECT_NEAR(errors.t_percent, 0, 1e-10);
    EXPECT_NEAR(errors.r_deg_per_100m, 0, 1e-10);
}

TEST(KittiMetric, AScaleErrorOfOnePercentIsOnePercent) {
    const auto errors =
        kittiErrors(straight(kStep_m, 2000), straight(1.01 * kStep_m, 2000), kittiLengths_m());
    for (const auto& one : errors.perLength) {
        // The kit divides by the length asked for, though the segment is a step longer.
        EXPECT_NEAR(one.t_percent, 1 + kStep_m / one.length_m, 1e-9);
        EXPECT_NEAR(one.r_deg_per_100m, 0, 1e-12);
    }
    const double fine = 1.0 / 1024;
    const auto exact = kittiErrors(straight(fine, 3000), straight(1.01 * fine, 3000), {2});
    EXPECT_NEAR(exact.t_percent, 1, 1e-3);
}

TEST(KittiMetric, AYawDriftGivesItsDegreesPer100MetresAndItsArc) {
    const double driftPerMetre_deg = 0.02;
    const double turn = mrpt::DEG2RAD(driftPerMetre_deg) * kStep_m;
    const auto motion = poseAt(kStep_m, 0, 0, turn, 0, 0);
    const auto errors =
        kittiErrors(chain(poseAt(kStep_m, 0, 0), 2000), chain(motion, 2000), kittiLengths_m());
    for (const auto& one : errors.perLength) {
        const double driven = one.length_m + kStep_m;
        EXPECT_NEAR(one.r_deg_per_100m, 100 * driftPerMetre_deg * driven / one.length_m, 1e-9);
        // From the end of the chord of the arc to the end of the straight line.
        const double n = driven / kStep_m;
        const double chord = kStep_m * std::sin(n * turn / 2) / std::sin(turn / 2);
        const double gap = std::hypot(chord * std::cos((n - 1) * turn / 2) - driven,
                                      chord * std::sin((n - 1) * turn / 2));
        EXPECT_NEAR(one.t_percent, 100 * gap / one.length_m, 1e-9);
    }
}

TEST(KittiMetric, CountsSegmentsAsTheKitDoes) {
    // 1001 poses, 500 m: a segment of L ends one pose after it has L metres, so it has to begin at
    // or before pose 1000 - (2 L + 1); every tenth pose is a start.
    const auto drive = straight(kStep_m, 1001);
    const auto errors = kittiErrors(drive, drive);
    const std::vector<std::size_t> wanted = {80, 60, 40, 20, 0, 0, 0, 0};
    for (std::size_t i = 0; i < wanted.size(); ++i)
        EXPECT_EQ(errors.perLength[i].segments, wanted[i]);
    EXPECT_EQ(errors.segments, 200U);
    EXPECT_TRUE(std::isnan(errors.perLength[4].t_percent));
}

TEST(KittiMetric, TheMeanIsOverSegmentsNotOverLengths) {
    const auto errors = kittiErrors(straight(kStep_m, 1001), straight(1.01 * kStep_m, 1001));
    double sum = 0;
    for (const auto& one : errors.perLength)
        if (one.segments) sum += one.t_percent * static_cast<double>(one.segments);
    EXPECT_NEAR(errors.t_percent, sum / 200, 1e-12);
}

TEST(KittiMetric, ADriveThatIsTooShortHasNoFigure) {
    for (const auto& drive : {Poses(), straight(kStep_m, 1), straight(kStep_m, 201)}) {
        const auto errors = kittiErrors(drive, drive);
        EXPECT_EQ(errors.segments, 0U);
        EXPECT_TRUE(std::isnan(errors.t_percent));
        EXPECT_TRUE(std::isnan(errors.r_deg_per_100m));
    }
}

TEST(KittiMetric, TheFixedFramesMayDiffer) {
    const auto drive = chain(poseAt(1, 0, 0, 0.01, 0, 0), 500);
    auto moved = drive;
    const auto world = poseAt(400, -90, 7, 2, 0.4, 1);
    for (auto& pose : moved) pose = world * pose;
    EXPECT_NEAR(kittiErrors(drive, moved).t_percent, 0, 1e-9);
}

TEST(KittiMetric, SuggestedLengthsHaveSegments) {
    EXPECT_EQ(suggestedLengths_m(12.9), (std::vector<double>{1, 2, 3, 4}));
    EXPECT_EQ(suggestedLengths_m(81), (std::vector<double>{10, 20, 30, 40}));
    EXPECT_EQ(suggestedLengths_m(69.4), (std::vector<double>{5, 10, 15, 20}));
    EXPECT_TRUE(suggestedLengths_m(0).empty());
}
}  // namespace
