#include "delio/evaluation/metrics.h"

#include <gtest/gtest.h>
#include <mrpt/core/bits_math.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "delio/core/geometry.h"
#include "poses.h"

namespace {
using namespace delio::evaluation;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

/** A turn by `angle_rad` about a slanting axis, with `noise` on every entry of the matrix. */
Eigen::Isometry3d turn(double angle_rad, double noise = 0) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
    Eigen::Matrix3d R = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) += i % 2 ? noise : -noise;
    return delio::isometry(R, Eigen::Vector3d::Zero());
}

TEST(RotationAngle, IsExactFromZeroToHalfATurn) {
    EXPECT_EQ(rotationAngle_rad(Eigen::Isometry3d::Identity()), 0);
    for (const double angle : {1e-12, 1e-8, 1e-3, 1.0, M_PI / 2, 3.0, M_PI - 1e-8, M_PI})
        EXPECT_NEAR(rotationAngle_rad(turn(angle)), angle, 1e-14) << angle;
}

TEST(RotationAngle, NoiseOfTheMatrixMovesItNoMoreThanTheNoise) {
    constexpr double noise = 1e-7;  // what a file with seven digits has; acos would give 3e-4
    for (const double angle : {0.0, 1e-6, 1.0, M_PI - 1e-6, M_PI})
        EXPECT_NEAR(rotationAngle_rad(turn(angle, noise)), angle, 3 * noise) << angle;
}

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

/** A winding drive in three dimensions. */
Poses winding() {
    Poses poses;
    for (int i = 0; i < 200; ++i)
        poses.push_back(poseAt(i, 30 * std::sin(0.05 * i), 2 * std::cos(0.02 * i), 0.1 * i, 0, 0));
    return poses;
}

/** Every second pose moved up, the others down: no rigid motion takes that back. */
Poses shaken(const Poses& poses, double by_m) {
    Poses result = poses;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i].translation().z() += i % 2 ? by_m : -by_m;
    return result;
}

TEST(AbsoluteError, NoRigidMotionChangesIt) {
    const auto drive = winding();
    EXPECT_NEAR(absoluteError(drive, drive).rmse_m, 0, 1e-9);
    const auto estimate = shaken(drive, 0.25);
    const auto plain = absoluteError(drive, estimate);
    EXPECT_NEAR(plain.rmse_m, 0.25, 1e-3);
    EXPECT_NEAR(plain.max_m, 0.25, 5e-3);
    for (const double yaw : {0.5, 3.1}) {
        const auto world = poseAt(4e5, -5e6, 100, yaw, -1, 2);
        auto moved = estimate;
        for (auto& pose : moved) pose = world * pose;
        EXPECT_NEAR(absoluteError(drive, moved).rmse_m, plain.rmse_m, 1e-6);
        EXPECT_NEAR(absoluteError(drive, moved).max_m, plain.max_m, 1e-6);
    }
}

TEST(AbsoluteError, ScaleIsAnError) {
    // 0, 1, ... 100 m against the same 1 % longer: the residuals after centring are 1 % of -50..50.
    Poses drive, longer;
    double squares = 0;
    for (int i = 0; i <= 100; ++i) {
        drive.push_back(poseAt(i, 0, 0));
        longer.push_back(poseAt(1.01 * i, 0, 0));
        squares += std::pow(0.01 * (i - 50), 2);
    }
    EXPECT_NEAR(absoluteError(drive, longer).rmse_m, std::sqrt(squares / 101), 1e-9);
    EXPECT_NEAR(absoluteError(drive, longer).max_m, 0.5, 1e-9);
}

TEST(AbsoluteError, AMirroredDriveIsNotAligned) {
    const auto drive = winding();
    auto mirrored = drive;
    for (auto& pose : mirrored) pose.translation().y() *= -1;
    EXPECT_GT(absoluteError(drive, mirrored).rmse_m, 0.5);
}

TEST(AbsoluteError, FewPosesAreNoTrap) {
    EXPECT_TRUE(std::isnan(absoluteError({}, {}).rmse_m));
    EXPECT_NEAR(absoluteError({poseAt(1, 2, 3)}, {poseAt(9, 9, 9)}).rmse_m, 0, 1e-12);
    EXPECT_NEAR(
        absoluteError({poseAt(0, 0, 0), poseAt(0, 0, 2)}, {poseAt(0, 0, 0), poseAt(3, 0, 0)})
            .rmse_m,
        0.5, 1e-12);
}

TEST(RelativeError, SpreadOfAList) {
    std::vector<double> list(100);
    std::iota(list.rbegin(), list.rend(), 1);  // 100, 99, ... 1
    const auto spread = spreadOf(list);
    EXPECT_DOUBLE_EQ(spread.median, 50.5);
    EXPECT_DOUBLE_EQ(spread.p95, 95);
    EXPECT_DOUBLE_EQ(spread.max, 100);
    EXPECT_DOUBLE_EQ(spread.rmse, std::sqrt(101 * 201 / 6.0));
    EXPECT_DOUBLE_EQ(spreadOf({3}).p95, 3);
    EXPECT_DOUBLE_EQ(spreadOf({1, 9, 2}).median, 2);
    EXPECT_TRUE(std::isnan(spreadOf({}).median));
}

TEST(RelativeError, OneBadStepIsOneBadEntry) {
    const auto drive = chain(poseAt(1, 0, 0, 0.1, 0, 0), 50);
    auto estimate = drive;
    // From pose 20 on everything is displaced as a body: only the motion from 19 to 20 is wrong.
    const Eigen::Isometry3d slip = poseAt(0.3, 0.4, 0, mrpt::DEG2RAD(2.0), 0, 0);
    for (std::size_t i = 20; i < 50; ++i)
        estimate[i] = drive[20] * slip * drive[20].inverse() * drive[i];
    const auto error = relativeError(drive, estimate);
    ASSERT_EQ(error.translations_m.size(), 49U);
    for (std::size_t i = 0; i < 49; ++i) {
        EXPECT_NEAR(error.translations_m[i], i == 19 ? 0.5 : 0, 1e-10);
        EXPECT_NEAR(error.rotations_deg[i], i == 19 ? 2 : 0, 1e-10);
    }
    EXPECT_NEAR(error.translation_m.rmse, 0.5 / 7, 1e-10);
    EXPECT_NEAR(error.rotation_deg.rmse, 2.0 / 7, 1e-10);
    EXPECT_NEAR(error.translation_m.median, 0, 1e-10);
    EXPECT_NEAR(error.rotation_deg.max, 2, 1e-10);
}

TEST(RelativeError, SpansDeltaPoses) {
    const auto drive = chain(poseAt(1, 0, 0), 30), longer = chain(poseAt(1.01, 0, 0), 30);
    EXPECT_NEAR(relativeError(drive, longer, 1).translation_m.rmse, 0.01, 1e-12);
    EXPECT_NEAR(relativeError(drive, longer, 10).translation_m.rmse, 0.1, 1e-12);
    EXPECT_EQ(relativeError(drive, longer, 10).translations_m.size(), 20U);
    EXPECT_TRUE(std::isnan(relativeError(drive, longer, 30).translation_m.rmse));
    EXPECT_TRUE(std::isnan(relativeError({}, {}, 1).rotation_deg.rmse));
}
}  // namespace
