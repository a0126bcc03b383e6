#include <gtest/gtest.h>

#include "odometry/arrivals.h"
#include "odometry_drive.h"
#include "swing.h"

// Scans that drivers and recorders repeat: a copy says nothing about the motion.
namespace {
using namespace delio;
using namespace delio::odometry;
using namespace delio::odometry_test;
using Eigen::Isometry3d;

constexpr std::size_t kScans = 10, kRepeated = 5;

/** A straight drive with 1 m a scan, ten scans a second. */
Poses straight() {
    Poses poses;
    for (std::size_t i = 0; i < kScans; ++i)
        poses.push_back(poseAtDeg(-3 + static_cast<double>(i), 1, 0, 2));
    return poses;
}

std::vector<Scan> stampedScansOf(const Poses& poses) {
    auto scans = scansOf(poses);
    for (std::size_t i = 0; i < scans.size(); ++i) scans[i].stamp_s = 0.1 * static_cast<double>(i);
    return scans;
}

/** Pose of each scan relative to the first. */
Poses posesOf(const std::vector<Step>& steps) {
    Poses poses;
    Isometry3d pose = Isometry3d::Identity();
    for (const auto& step : steps) {
        pose = pose * step.increment.pose;
        poses.push_back(pose);
    }
    return poses;
}

class RepeatedScan : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Odometry, RepeatedScan, testing::Values("accurate", "paper"),
                         [](const auto& profile) { return profile.param; });

// The same place once more, with other noise, so soon that noise over time is no speed.
TEST_P(RepeatedScan, SoonAfterTheFirstChangesNothing) {
    const auto truth = test::fromFirst(straight());
    for (const double later_s : {2e-6, 5e-5, 1e-3, 0.019}) {
        auto scans = stampedScansOf(straight());
        Scan again = scanAt(straight()[kRepeated], 1000);
        again.stamp_s = scans[kRepeated].stamp_s + later_s;
        scans.insert(scans.begin() + kRepeated + 1, again);
        const auto steps = stepsOf(scans, quick(GetParam(), 2));
        const auto poses = posesOf(steps);
        for (std::size_t i = 0; i < scans.size(); ++i) {
            EXPECT_EQ(steps[i].predicted, i == kRepeated + 1) << i << " " << steps[i].reason;
            const std::size_t of = i > kRepeated ? i - 1 : i;
            const double driven_m = i == kRepeated + 1 ? 10 * later_s : 0;
            expectPose(poses[i], truth[of] * poseAtDeg(driven_m, 0, 0, 0), 3 * kMetres, kDegrees);
        }
        EXPECT_EQ(steps[kRepeated + 1].reason, "too soon after the scan before it");
    }
}

// The driver sends a scan again with the next stamp; what was to be seen then is lost.
TEST_P(RepeatedScan, InPlaceOfTheNextOneIsPredicted) {
    const auto truth = test::fromFirst(straight());
    auto scans = stampedScansOf(straight());
    scans[kRepeated + 1].points = scans[kRepeated].points;
    const auto steps = stepsOf(scans, quick(GetParam(), 2));
    const auto poses = posesOf(steps);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        EXPECT_EQ(steps[i].predicted, i == kRepeated + 1) << i << " " << steps[i].reason;
        expectPose(poses[i], truth[i], 3 * kMetres, kDegrees);
    }
    EXPECT_EQ(steps[kRepeated + 1].reason, "copy of the scan before it");
}

TEST_P(RepeatedScan, AsTheSecondOneDoesNotSayThatTheSensorStands) {
    const auto truth = test::fromFirst(straight());
    auto scans = stampedScansOf(straight());
    scans[1].points = scans[0].points;
    const auto steps = stepsOf(scans, quick(GetParam(), 3));
    const auto poses = posesOf(steps);
    EXPECT_TRUE(steps[1].predicted);
    for (std::size_t i = 2; i < scans.size(); ++i) {
        EXPECT_FALSE(steps[i].predicted) << i << " " << steps[i].reason;
        expectPose(poses[i], truth[i], 4 * kMetres, kDegrees);
    }
}

// A simulator without noise.
TEST_P(RepeatedScan, AgainAndAgainIsASensorAtRest) {
    auto scans = stampedScansOf(straight());
    for (auto& scan : scans) scan.points = scans[0].points;
    const auto steps = stepsOf(scans, quick(GetParam()));
    for (std::size_t i = 0; i < scans.size(); ++i) {
        EXPECT_EQ(steps[i].predicted, i == 1) << i << " " << steps[i].reason;
        expectPose(steps[i].increment.pose, Isometry3d::Identity(), 3e-3, 0.01);
    }
}

TEST(Arrivals, ScansOfAFewPointsAreNoCopies) {
    Arrivals arrivals(false);
    for (int i = 0; i < 3; ++i) {
        Scan scan = test::scanOf(Eigen::Matrix3Xf::Constant(3, 5, 4.0F));
        scan.stamp_s = 0.1 * i;
        EXPECT_EQ(arrivals.take(scan, scan.stamp_s).copies, 0U);
    }
}

TEST(Arrivals, OneOtherPointInAThousandIsNoCopy) {
    Arrivals arrivals(false);
    Eigen::Matrix3Xf points = Eigen::Matrix3Xf::Random(3, 900);
    EXPECT_EQ(arrivals.take(test::scanOf(points), 0).copies, 0U);
    EXPECT_EQ(arrivals.take(test::scanOf(points), 0).copies, 1U);
    EXPECT_EQ(arrivals.take(test::scanOf(points), 0).copies, 2U);
    points(1, 437) += 1e-3F;
    EXPECT_EQ(arrivals.take(test::scanOf(points), 0).copies, 0U);
}

/** Scans with times (all at the stamp) but for those from `from` to `to`. */
std::vector<Step> withoutTimes(std::size_t from, std::size_t to, bool deskew) {
    auto scans = stampedScansOf(straight());
    for (std::size_t i = 0; i < scans.size(); ++i)
        if (i < from || i > to) scans[i].times_s.assign(scans[i].points->size(), 0.0F);
    auto options = quick("accurate");
    options.planes.scan.deskew = deskew;
    return stepsOf(scans, options);
}

// Their pose would be that of another moment, and in the map they would blur it.
TEST(ScansThatLoseTheirTimes, ArePredictedAtFirst) {
    const auto truth = test::fromFirst(straight());
    for (const std::size_t from : {std::size_t{1}, std::size_t{4}}) {
        const auto steps = withoutTimes(from, from, true);
        const auto poses = posesOf(steps);
        for (std::size_t i = 0; i < kScans; ++i) {
            EXPECT_EQ(steps[i].predicted, i == from) << i << " " << steps[i].reason;
            if (i != 1) expectPose(poses[i], truth[i], 3 * kMetres, kDegrees);
        }
        EXPECT_EQ(steps[from].reason, "points without times");
    }
    const auto steps = withoutTimes(3, kScans, true);  // for good: as they come
    for (std::size_t i = 0; i < kScans; ++i)
        EXPECT_EQ(steps[i].predicted, i >= 3 && i < 6) << i << " " << steps[i].reason;
    for (const auto& step : withoutTimes(3, 4, false)) EXPECT_FALSE(step.predicted);
}

/** A turn of 0.1 s on a straight way at 10 m/s. The points' times count from the begin of the turn,
 *  which is the stamp, but for its error. */
Scan turnAt(std::size_t i, double error_s) {
    constexpr double kHalf_s = 0.05;
    const double begin_s = 0.1 * static_cast<double>(i);
    const auto sweep = test::sweep(test::yard(), 0.01, begin_s + kHalf_s, [](double time_s) {
        return poseAtDeg(-4 + 10 * time_s, 1, 0, 0);
    });
    Scan scan = test::scanOf(sweep.points.cast<float>());
    for (const double time_s : sweep.times_s)
        scan.times_s.push_back(static_cast<float>(time_s + kHalf_s));
    scan.stamp_s = begin_s + error_s;
    return scan;
}

/** Metres: the worst of the steps after the first ones, which have to be 1 m. */
double worstStep(double jitter_s) {
    test::Noise noise(5);
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < 20; ++i) scans.push_back(turnAt(i, jitter_s * noise.uniform()));
    const auto steps = stepsOf(scans, quick("accurate"));
    double worst_m = 0;
    for (std::size_t i = 5; i < steps.size(); ++i)
        worst_m = std::max(
            worst_m, (steps[i].increment.pose.translation() - Eigen::Vector3d(1, 0, 0)).norm());
    return worst_m;
}

// The times of the points are exact, the stamps say when a message arrived.
TEST(StampsThatJitter, AreEvenedOut) {
    EXPECT_LT(worstStep(0), 0.03);
    EXPECT_LT(worstStep(0.03), 0.06);
}

/** Seconds: the largest difference between the intervals and those of the stamps without error. */
double worstInterval(const std::vector<double>& errors_s, const std::vector<std::size_t>& turns) {
    TurnClock clock;
    double worst_s = 0, before_s = 0;
    for (std::size_t k = 0; k < turns.size(); ++k) {
        const Scan scan = turnAt(turns[k], errors_s[k]);
        const double evened_s = scan.stamp_s + clock.correction_s(scan);
        constexpr std::size_t kSettled = 4;
        if (k >= kSettled)
            worst_s = std::max(
                worst_s,
                std::abs(evened_s - before_s - 0.1 * static_cast<double>(turns[k] - turns[k - 1])));
        before_s = evened_s;
    }
    return worst_s;
}

TEST(TurnClock, EvensJitterAndKeepsGaps) {
    const std::vector<double> none(12),
        errors_s{0.01, -0.02, 0.02, -0.01, 0.03, -0.02, -0.01, 0.02, 0.01, -0.03, 0.025, 0};
    const std::vector<std::size_t> all{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
        some{0, 1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 14};
    EXPECT_LT(worstInterval(errors_s, all), 0.012);
    EXPECT_LT(worstInterval(errors_s, some), 0.012);
    EXPECT_LT(worstInterval(none, some), 1e-9);
}

// Stamps without jitter stay as they are, and so do those of scans whose points have no times.
TEST(TurnClock, LeavesOtherStampsAsTheyAre) {
    TurnClock even, untimed, overlapping;
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(even.correction_s(turnAt(i, i % 2 == 0 ? 0.002 : 0)), 0);
        Scan scan = turnAt(i, i % 2 == 0 ? 0.03 : 0);
        scan.times_s.clear();
        EXPECT_EQ(untimed.correction_s(scan), 0);
    }
    // Twice as many scans as turns: each shares half of its points with the one before.
    for (std::size_t i = 0; i < 20; ++i) {
        const double late_s = overlapping.correction_s(turnAt(i, -0.05 * static_cast<double>(i)));
        if (i > 10) {
            EXPECT_EQ(late_s, 0);
        }
    }
}

TEST(TurnClock, AStampThatIsNoNumberIsPassedOver) {
    TurnClock clock;
    for (std::size_t i = 0; i < 8; ++i) {
        const double error_s = i == 4 ? std::nan("") : i % 2 == 0 ? 0.03 : 0;
        const double late_s = clock.correction_s(turnAt(i, error_s));
        EXPECT_LT(std::abs(late_s), 0.05) << i;
    }
}
}  // namespace
