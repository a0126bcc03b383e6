#include "odometry/register_together.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "swing.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using test::degreesBetween;
using test::metresBetween;
using test::swung;

/** A turn about `middle_s`. */
PointCloud scanAt(double middle_s, const std::function<Isometry3d(double)>& pose = swung) {
    const TimedPoints sweep = test::sweep(test::yard(), 0.01, middle_s, pose);
    PointCloud cloud;
    cloud.points = sweep.points.cast<float>();
    cloud.times_s.assign(sweep.times_s.begin(), sweep.times_s.end());
    return cloud;
}

/** Errors of the motion from the first scan's middle, over the times of a trajectory. */
void expectSwing(const ScanTrajectory& found, double last_s, double most_m, double most_deg) {
    for (double time_s = 0; time_s <= last_s + 0.04; time_s += 0.01) {
        const Isometry3d moved = found.at(0).inverse() * found.at(time_s),
                         truth = swung(0).inverse() * swung(time_s);
        EXPECT_LT(metresBetween(moved, truth), most_m) << time_s;
        EXPECT_LT(degreesBetween(moved, truth), most_deg) << time_s;
    }
}

ScanTrajectory standing(double first_s, double last_s) {
    std::vector<double> times_s;
    for (double time_s = first_s; times_s.size() < 2 || times_s.back() < last_s; time_s += 0.02)
        times_s.push_back(time_s);
    return ScanTrajectory::even(times_s, Isometry3d::Identity(), Twist{});
}

TEST(RegisterTogether, FindsASwingFromStandingAlone) {
    const std::deque<TimedScan> scans{timedScanOf(scanAt(0), 0), timedScanOf(scanAt(0.1), 0.1),
                                      timedScanOf(scanAt(0.2), 0.2)};
    EXPECT_GT(degreesBetween(swung(0), swung(0.2)), 8);
    const auto start = standing(-0.05, 0.25);
    const Together found = registerTogether(scans, start, 2);
    expectSwing(found.trajectory, 0.2, 0.03, 0.3);
    EXPECT_GT(found.inlierRatio, registerTogether(scans, start, 0.15).inlierRatio);
}

TEST(RegisterTogether, KeepsTheFirstPoseAndTheTimes) {
    const std::deque<TimedScan> scans{timedScanOf(scanAt(0), 0), timedScanOf(scanAt(0.1), 0.1)};
    const auto start = standing(-0.05, 0.15);
    const auto found = registerTogether(scans, start, 1).trajectory;
    EXPECT_EQ(found.times_s(), start.times_s());
    EXPECT_LT(metresBetween(found.poses().front(), start.poses().front()), 1e-6);
    EXPECT_LT(degreesBetween(found.poses().front(), start.poses().front()), 1e-4);
}

TEST(RegisterTogether, IsTheSameForAnyNumberOfThreads) {
    const std::deque<TimedScan> scans{timedScanOf(scanAt(0), 0), timedScanOf(scanAt(0.1), 0.1)};
    const auto onThreads = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return registerTogether(scans, standing(-0.05, 0.15), 1);
    };
    const auto one = onThreads(1), two = onThreads(2);
    EXPECT_EQ(one.inlierRatio, two.inlierRatio);
    for (std::size_t k = 0; k < one.trajectory.poses().size(); ++k)
        EXPECT_EQ(one.trajectory.poses()[k].matrix(), two.trajectory.poses()[k].matrix());
}

TEST(RegisterTogether, WithoutPointsTheTrajectoryStays) {
    PointCloud few;
    few.points = Eigen::Matrix3Xf::Constant(3, 4, 5);
    few.times_s.assign(4, 0);
    const std::deque<TimedScan> scans{timedScanOf(few, 0), timedScanOf(few, 0.1)};
    const auto start = standing(-0.05, 0.15);
    const auto found = registerTogether(scans, start, 1);
    EXPECT_EQ(found.inlierRatio, 0);
    EXPECT_LT(metresBetween(found.trajectory.poses().back(), start.poses().back()), 1e-9);
}

TEST(ScanWindow, FollowsASwingScanByScan) {
    ScanWindow window;
    window.begin(timedScanOf(scanAt(0), 0), Twist{});
    ASSERT_TRUE(window.addSecond(scanAt(0.1), 0.1, Twist{}, false));
    for (const double time_s : {0.2, 0.3, 0.4, 0.5})
        ASSERT_TRUE(window.add(scanAt(time_s), time_s));
    EXPECT_TRUE(window.isFull());
    EXPECT_EQ(window.scans().front().time_s, 0.2);
    const auto& found = window.trajectory();
    const Isometry3d moved = found.at(0.2).inverse() * found.at(0.5),
                     truth = swung(0.2).inverse() * swung(0.5);
    EXPECT_LT(metresBetween(moved, truth), 0.03);
    EXPECT_LT(degreesBetween(moved, truth), 0.3);
}

// A sensor that takes all points of a scan within a few milliseconds.
TEST(ScanWindow, ScansMayBeShorterThanTheTrajectorysIntervals) {
    const auto flash = [](double time_s) {
        PointCloud cloud = scanAt(time_s);
        for (float& point_s : cloud.times_s) point_s /= 20;
        return cloud;
    };
    ScanWindow window;
    window.begin(timedScanOf(flash(0), 0), Twist{});
    window.add(flash(0.05), 0.05);
    for (const auto& pose : window.trajectory().poses()) EXPECT_TRUE(pose.matrix().allFinite());
}

TEST(ScanWindow, AConstantMotionNeedsNoWindow) {
    const Twist drive{{3, 0, 0}, {0, 0, 0.2}};
    const auto pose = [&](double time_s) { return drive.after(time_s); };
    ScanWindow window;
    window.begin(timedScanOf(scanAt(0, pose), 0), Twist{});
    EXPECT_FALSE(window.addSecond(scanAt(0.1, pose), 0.1, drive, true));
}

TEST(ScanWindow, MovesAsAWhole) {
    ScanWindow window;
    window.begin(timedScanOf(scanAt(0), 0), Twist{});
    window.add(scanAt(0.1), 0.1);
    const auto before = window.trajectory();
    const Isometry3d pose = test::poseAt(3, 2, 1, 0.5);
    window.moveTo(pose);
    EXPECT_LT(metresBetween(window.trajectory().at(0.1), pose), 1e-9);
    EXPECT_LT(metresBetween(window.trajectory().at(0).inverse() * pose,
                            before.at(0).inverse() * before.at(0.1)),
              1e-9);
}
}  // namespace
