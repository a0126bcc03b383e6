#include "delio/odometry/odometry.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "odometry_drive.h"

namespace {
using namespace delio;
using namespace delio::odometry_test;

std::string nameOf(const std::string& profile) { return profile == "paper" ? "Paper" : "Planes"; }

/** What both odometries can do, each with its profile. */
class EitherOdometry : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Odometry, EitherOdometry, testing::Values("accurate", "paper"),
                         [](const auto& profile) { return nameOf(profile.param); });

TEST_P(EitherOdometry, FindsTheIncrementsOfADrive) {
    const auto truth = drive(6);
    const auto steps = stepsOf(scansOf(truth), quick(GetParam(), 1));
    EXPECT_FALSE(steps[0].predicted);
    expectNoMotion(steps[0].increment.pose);
    for (std::size_t i = 1; i < truth.size(); ++i) {
        const auto& step = steps[i];
        EXPECT_FALSE(step.predicted) << step.reason;
        EXPECT_EQ(step.reason, "");
        expectPose(step.increment.pose, stepTo(truth, i), kMetres, kDegrees);
        expectCovariance(step.increment);
        EXPECT_EQ(step.notFinite, 0U);
        EXPECT_FALSE(step.deskewed);
        EXPECT_GT(step.used.indices.size(), 8000U);
        EXPECT_EQ(static_cast<std::size_t>(step.used.points.cols()), step.used.indices.size());
        EXPECT_GT(step.quality.matches, 0U);
        EXPECT_FALSE(step.times_ms.empty());
        for (const auto& [name, ms] : step.times_ms) EXPECT_GE(ms, 0) << name;
    }
}

TEST_P(EitherOdometry, EveryStepNamesTheSameTimesAndDetails) {
    auto scans = scansOf(drive(4));
    scans[2] = test::scanOf({});
    const auto steps = stepsOf(scans, quick(GetParam(), 1));
    const auto names = [](const std::vector<Named>& values) {
        std::vector<std::string> result;
        for (const auto& value : values) result.emplace_back(value.first);
        return result;
    };
    for (const auto& step : steps) {
        EXPECT_EQ(names(step.times_ms), names(steps[0].times_ms));
        EXPECT_EQ(names(step.details), names(steps[0].details));
    }
}

// 25 m/s from the first scan on, of which nothing is known before.
TEST_P(EitherOdometry, ADriveThatBeginsAtSpeedIsRegistered) {
    Poses truth{poseAtDeg(-7, 1, 0, 20)};
    while (truth.size() < 4) truth.push_back(truth.back() * poseAtDeg(2.5, 0, 0, 1));
    const auto steps = stepsOf(scansOf(truth), Options::ofProfile(GetParam()));
    for (std::size_t i = 1; i < truth.size(); ++i) {
        EXPECT_FALSE(steps[i].predicted) << i;
        expectPose(steps[i].increment.pose, stepTo(truth, i), 0.1, 0.5);
    }
}

// At a constant speed, but scans are missing: what is expected of a step grows with its time.
TEST_P(EitherOdometry, DroppedScansAreBridged) {
    Poses truth{poseAtDeg(-4, 0, 0, 10)};
    std::vector<double> stamps{100};
    for (const int missing : {0, 0, 0, 2, 0, 3, 0}) {
        Eigen::Isometry3d pose = truth.back();
        for (int i = 0; i <= missing; ++i) pose = pose * poseAtDeg(0.5, 0, 0, -2.5);
        truth.push_back(pose);
        stamps.push_back(stamps.back() + 0.1 * (missing + 1));
    }
    auto scans = scansOf(truth);
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp_s = stamps[i];
    const auto steps = stepsOf(scans, quick(GetParam(), 1));
    for (std::size_t i = 1; i < truth.size(); ++i) {
        EXPECT_FALSE(steps[i].predicted) << i;
        expectPose(steps[i].increment.pose, stepTo(truth, i), 0.05, 0.5);
    }
}

// Scans of one place, each with its own noise.
TEST_P(EitherOdometry, AVehicleAtRestStaysThere) {
    const auto place = poseAtDeg(0, 0, 0, 30);
    std::vector<Scan> scans;
    for (std::uint32_t seed = 0; seed < 4; ++seed) scans.push_back(scanAt(place, seed));
    const auto steps = stepsOf(scans, quick(GetParam()));
    for (std::size_t i = 1; i < steps.size(); ++i) {
        EXPECT_FALSE(steps[i].predicted);
        expectPose(steps[i].increment.pose, Eigen::Isometry3d::Identity(), 0.005, 0.05);
    }
}

// Stop and go: every step is predicted too short.
TEST_P(EitherOdometry, AVehicleThatStartsFromRestIsFollowed) {
    Poses truth(2, poseAtDeg(0, 0, 0, 30));
    for (const double step : {0.03, 0.06, 0.12, 0.2, 0.3})
        truth.push_back(truth.back() * poseAtDeg(step, 0, 0, 0));
    const auto steps = stepsOf(scansOf(truth, test::room()), quick(GetParam()));
    for (std::size_t i = 1; i < truth.size(); ++i)
        expectPose(steps[i].increment.pose, stepTo(truth, i), kMetres, kDegrees);
}

TEST(Odometry, AScanThatIsThereTwiceIsNoMotion) {
    const auto place = drive(1).front();
    for (const auto& profile : Options::profileNames()) {
        const auto atRest = stepsOf({scanAt(place, 0), scanAt(place, 0)}, quick(profile));
        EXPECT_EQ(atRest[1].reason, "too soon after the scan before it") << profile;
        expectPose(atRest[1].increment.pose, Eigen::Isometry3d::Identity(), 1e-9, 1e-9);
        expectCovariance(atRest[1].increment);
    }
}

// Where half a metre was predicted.
TEST_P(EitherOdometry, AScanThatIsThereTwiceInTheMiddleOfADriveIsNoMotion) {
    const auto truth = drive(4);
    auto scans = scansOf(truth);
    scans.insert(scans.begin() + 3, scans[2]);
    const auto steps = stepsOf(scans, quick(GetParam()));
    EXPECT_EQ(steps[3].reason, "too soon after the scan before it");
    expectPose(steps[3].increment.pose, Eigen::Isometry3d::Identity(), 1e-4, 1e-3);
    expectCovariance(steps[3].increment);
    expectPose(steps[4].increment.pose, stepTo(truth, 3), kMetres, kDegrees);
}

TEST_P(EitherOdometry, PointsThatAreNotFiniteAreCountedAndNoMore) {
    const auto truth = drive(3);
    auto scans = scansOf(truth);
    for (int i = 0; i < 300; ++i)
        scans[1].points->insertPointFast(std::numeric_limits<float>::quiet_NaN(), 1, 1);
    const auto steps = stepsOf(scans, quick(GetParam()));
    EXPECT_EQ(steps[1].notFinite, 300U);
    EXPECT_FALSE(steps[1].predicted);
    expectPose(steps[1].increment.pose, stepTo(truth, 1), kMetres, kDegrees);
}

TEST_P(EitherOdometry, SettlingAfterEachScanChangesNothing) {
    const auto scans = scansOf(drive(4));
    const auto steps = stepsOf(scans, quick(GetParam()));
    const auto odometry = makeOdometry(quick(GetParam()));
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const Step step = odometry->process(scans[i]);
        odometry->settle();
        EXPECT_EQ(step.increment.pose.matrix(), steps[i].increment.pose.matrix());
        EXPECT_EQ(step.used.points, steps[i].used.points);
    }
}

TEST_P(EitherOdometry, OneAndTwoThreadsGiveTheSameBytes) {
    const auto scans = scansOf(drive(4));
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return stepsOf(scans, quick(GetParam()));
    };
    const auto one = with(1), two = with(2);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto &a = one[i], &b = two[i];
        EXPECT_EQ(a.increment.pose.matrix(), b.increment.pose.matrix());
        EXPECT_EQ(a.increment.covariance, b.increment.covariance);
        EXPECT_EQ(a.used.points, b.used.points);
        EXPECT_EQ(a.used.indices, b.used.indices);
        EXPECT_EQ(a.used.dynamic, b.used.dynamic);
        EXPECT_EQ(a.quality.residual_m, b.quality.residual_m);
        EXPECT_EQ(a.quality.matches, b.quality.matches);
        EXPECT_EQ(a.quality.rotationObservability, b.quality.rotationObservability);
        EXPECT_EQ(a.quality.translationObservability, b.quality.translationObservability);
        for (std::size_t k = 0; k < a.details.size(); ++k)
            EXPECT_EQ(a.details[k].second, b.details[k].second) << a.details[k].first;
    }
    EXPECT_GT(one[1].increment.pose.translation().norm(), 0.1);
}
}  // namespace
