#include "odometry/paper_odometry.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "odometry_drive.h"

namespace {
using namespace delio;
using namespace delio::odometry;
using namespace delio::odometry_test;

const PaperFeatures& featuresOf(const Step& step) {
    return dynamic_cast<const PaperFeatures&>(*step.features);
}

TEST(PaperOdometry, CountsItsFeatures) {
    const auto steps = stepsOf(scansOf(drive(6)), quick("paper", 1));
    for (std::size_t i = 1; i < steps.size(); ++i) {
        const auto& step = steps[i];
        EXPECT_GT(valueOf(step.details, "normals"), valueOf(step.details, "pattern"));
        EXPECT_GT(valueOf(step.details, "pattern"), 500);
        EXPECT_GT(valueOf(step.details, "lines"), 2500);
        EXPECT_EQ(static_cast<Eigen::Index>(valueOf(step.details, "lines")),
                  featuresOf(step).lines.midpoints.cols());
    }
}

// The drive of BadScan.InTheMiddle...
TEST(PaperOdometry, TheScanAfterAGapIsRegisteredAgainstTheOneBefore) {
    const auto truth = drive(6);
    auto scans = scansOf(truth);
    scans[4] = test::scanOf({});
    const auto options = quick("paper");
    const auto steps = stepsOf(scans, options);
    const auto found =
        registerFeatures(featuresOf(steps[3]), featuresOf(steps[5]),
                         steps[4].increment.pose * steps[4].increment.pose, 0, options.paper);
    EXPECT_EQ(found.predictedReason, "");
    expectPose(found.increment.pose, truth[3].inverse() * truth[5], kMetres, kDegrees);
    // The gap's own increment is the prediction; the rest is the next one's. Both registrations
    // start from guesses that differ by rounding, and end at steps below
    // options.pattern.converged_deg.
    expectPose(steps[4].increment.pose * steps[5].increment.pose, found.increment.pose, 1e-5,
               options.paper.pattern.converged_deg);
    EXPECT_EQ(steps[5].quality.matches, found.translation.matches);
}

TEST(PaperOdometry, AnyTwoScansAreRegistered) {
    const auto truth = drive(5);
    const auto scans = scansOf(truth);
    const auto options = quick("paper").paper;
    PaperOdometry odometry(options);
    const auto last = odometry.process(scans[4]), first = odometry.process(scans[2]);
    const Eigen::Isometry3d motion = truth[4].inverse() * truth[2];
    const auto found = registerFeatures(featuresOf(last), featuresOf(first),
                                        motion * poseAtDeg(0.2, 0.1, 0, 1), 0, options);
    EXPECT_EQ(found.predictedReason, "");
    expectPose(found.increment.pose, motion, kMetres, kDegrees);
    expectCovariance(found.increment);
    EXPECT_GT(found.rotation_ms, 0);
    EXPECT_GT(found.translation_ms, 0);
}

TEST(PaperOdometry, FeaturesLinkToEarlierOnes) {
    const auto truth = drive(4);
    auto scans = scansOf(truth);
    scans[3] = test::scanOf({});
    const auto steps = stepsOf(scans, quick("paper"));
    const Eigen::Isometry3d motion = truth[0].inverse() * truth[2];
    const auto link = steps[2].features->linkTo(*steps[0].features, motion);
    ASSERT_TRUE(link);
    expectPose(link->increment.pose, motion, kMetres, kDegrees);
    expectCovariance(link->increment);
    EXPECT_GT(link->overlap, 0.5);
    EXPECT_LE(link->overlap, 1);
    EXPECT_FALSE(steps[3].features->linkTo(*steps[2].features, Eigen::Isometry3d::Identity()));
}

TEST(PaperOdometry, OneAndTwoThreadsGiveTheSameFeatures) {
    const auto scans = scansOf(drive(4));
    const auto options = quick("paper");
    struct Run {
        std::vector<Step> steps;
        std::vector<PaperRegistration> registrations;  // each against the one before
    };
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Run run{stepsOf(scans, options), {}};
        for (std::size_t i = 1; i < scans.size(); ++i)
            run.registrations.push_back(
                registerFeatures(featuresOf(run.steps[i - 1]), featuresOf(run.steps[i]),
                                 run.steps[i].increment.pose, 0, options.paper));
        return run;
    };
    const auto one = with(1), two = with(2);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        const auto &a = featuresOf(one.steps[i]), &b = featuresOf(two.steps[i]);
        EXPECT_EQ(a.pattern.directions, b.pattern.directions);
        EXPECT_EQ(a.pattern.weights, b.pattern.weights);
        EXPECT_EQ(a.lines.midpoints, b.lines.midpoints);
    }
    for (std::size_t i = 0; i < one.registrations.size(); ++i) {
        const auto &a = one.registrations[i], &b = two.registrations[i];
        EXPECT_GT(a.rotation.residual_rad, 0);
        EXPECT_EQ(a.rotation.residual_rad, b.rotation.residual_rad);
        EXPECT_EQ(a.translation.residual_m, b.translation.residual_m);
        EXPECT_EQ(a.rotation.observability, b.rotation.observability);
        EXPECT_EQ(a.translation.matches, b.translation.matches);
    }
}
}  // namespace
