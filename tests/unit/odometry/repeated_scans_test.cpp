#include <gtest/gtest.h>

#include "odometry/arrivals.h"
#include "odometry_drive.h"

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
}  // namespace
