#include <gtest/gtest.h>

#include <tuple>

#include "odometry_drive.h"

// Scans that cannot be registered, in both odometries.
namespace {
using namespace delio;
using namespace delio::odometry_test;

Scan scanOfNaN() {
    return test::scanOf(
        Eigen::Matrix3Xf::Constant(3, 5000, std::numeric_limits<float>::quiet_NaN()));
}

Scan fewPoints(std::uint32_t seed = 7) {
    test::Noise noise(seed);
    Eigen::Matrix3Xf points(3, 10);
    for (int i = 0; i < 10; ++i) points.col(i) = (10 * noise.direction()).cast<float>();
    return test::scanOf(points);
}

/** Profile, and what is wrong with the scan. */
class BadScan : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
    static std::string profile() { return std::get<0>(GetParam()); }
    static std::string kind() { return std::get<1>(GetParam()); }
    static Scan scan() {
        return kind() == "Empty" ? test::scanOf({}) : kind() == "NaN" ? scanOfNaN() : fewPoints();
    }
    static std::string reason() {
        if (kind() != "Ten") return "no points";
        return profile() == "paper" ? "no surfaces" : "too few points";
    }
    /** Where there is a map already. */
    static std::string laterReason() {
        return kind() == "Ten" && profile() == "accurate" ? "not found in the map" : reason();
    }
};

INSTANTIATE_TEST_SUITE_P(Odometry, BadScan,
                         testing::Combine(testing::Values("accurate", "paper"),
                                          testing::Values("Empty", "NaN", "Ten")),
                         [](const auto& values) {
                             return (std::get<0>(values.param) == "paper" ? "Paper" : "Planes") +
                                    std::get<1>(values.param);
                         });

TEST_P(BadScan, InTheMiddleIsPredictedAndTheNextOneIsRightAgain) {
    const auto truth = drive(7);
    auto scans = scansOf(truth);
    scans[4] = scan();
    const auto steps = stepsOf(scans, quick(profile()));
    EXPECT_TRUE(steps[4].predicted);
    EXPECT_EQ(steps[4].reason, laterReason());
    // The prediction: a drive as steady as this one goes on within centimetres.
    expectPose(steps[4].increment.pose, stepTo(truth, 4), 0.1, 1);
    expectCovariance(steps[4].increment);
    EXPECT_GT(steps[4].increment.covariance(0, 0), 0.01);  // and says that it is none too sure
    for (const std::size_t i : {1, 2, 3, 5, 6}) EXPECT_FALSE(steps[i].predicted) << i;
    // The next one is registered against what was before the gap: together they are right.
    expectPose(steps[4].increment.pose * steps[5].increment.pose, truth[3].inverse() * truth[5],
               kMetres, kDegrees);
    expectPose(steps[6].increment.pose, stepTo(truth, 6), kMetres, kDegrees);
    Eigen::Isometry3d pose = truth[0];
    for (const auto& step : steps) pose = pose * step.increment.pose;
    expectPose(pose, truth[6], 3 * kMetres, 3 * kDegrees);
}

TEST_P(BadScan, AtTheStartIsNoReference) {
    const auto truth = drive(3);
    auto scans = scansOf(truth);
    scans.insert(scans.begin(), scan());
    const auto steps = stepsOf(scans, quick(profile()));
    EXPECT_TRUE(steps[0].predicted);
    EXPECT_EQ(steps[0].reason, reason());
    expectNoMotion(steps[0].increment.pose);
    expectNoMotion(steps[1].increment.pose);
    EXPECT_TRUE(steps[1].predicted);  // no motion, but not a silent one
    EXPECT_EQ(steps[1].reason, "no usable scan before it");
    expectPose(steps[2].increment.pose, stepTo(truth, 1), kMetres, kDegrees);
    expectPose(steps[3].increment.pose, stepTo(truth, 2), kMetres, kDegrees);
    EXPECT_FALSE(steps[2].predicted);
    for (const auto& step : steps) expectCovariance(step.increment);
}

TEST_P(BadScan, AndNothingElse) {
    const auto steps = stepsOf({scan(), scan(), scan()}, quick(profile()));
    for (const auto& step : steps) {
        EXPECT_TRUE(step.predicted);
        EXPECT_NE(step.reason, "");
        expectNoMotion(step.increment.pose);
        expectCovariance(step.increment);
    }
}

TEST_P(BadScan, AsTheSecondIsNotTakenForARest) {
    const auto truth = drive(4);
    auto scans = scansOf(truth);
    scans[1] = scan();
    const auto steps = stepsOf(scans, quick(profile(), 1));
    EXPECT_TRUE(steps[1].predicted);
    EXPECT_FALSE(steps[2].predicted) << steps[2].reason;
    expectPose(steps[1].increment.pose * steps[2].increment.pose, truth[0].inverse() * truth[2],
               kMetres, kDegrees);
    expectPose(steps[3].increment.pose, stepTo(truth, 3), kMetres, kDegrees);
}

// They begin no map: the one before is kept, and the motion goes on meanwhile.
TEST(BadScans, ManyInARowArePredicted) {
    constexpr std::size_t kFirst = 6, kLast = 11;
    constexpr double kSlowest_m = 0.4, kNear_m = 1;
    const auto truth = drive(16);
    for (const bool isEmpty : {true, false}) {
        SCOPED_TRACE(isEmpty ? "empty" : "ten points");
        auto scans = scansOf(truth);
        for (std::size_t i = kFirst; i <= kLast; ++i) {
            const auto seed = static_cast<std::uint32_t>(i);  // a copy would be recognised
            scans[i].points = (isEmpty ? test::scanOf({}) : fewPoints(seed)).points;
        }
        const auto steps = stepsOf(scans, quick("accurate"));
        Eigen::Isometry3d pose = truth[0];
        for (std::size_t i = 0; i < steps.size(); ++i) {
            pose = pose * steps[i].increment.pose;
            const bool isBad = i >= kFirst && i <= kLast;
            EXPECT_EQ(steps[i].predicted, isBad) << i;
            EXPECT_EQ(steps[i].track, 0U) << i;
            if (isBad) {
                EXPECT_GT(steps[i].increment.pose.translation().norm(), kSlowest_m) << i;
            }
            EXPECT_LT(test::metresBetween(pose, truth[i]), isBad ? kNear_m : 3 * kMetres) << i;
        }
    }
}
}  // namespace
