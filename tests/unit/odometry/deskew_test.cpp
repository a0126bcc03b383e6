#include "odometry/deskew.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using test::poseAt;

/** The pose that the motion leads to after `time_s`, in many small steps. */
Eigen::Isometry3d poseAfter(const Twist& motion, double time_s) {
    constexpr int kSteps = 20000;
    const double dt = time_s / kSteps, angle = dt * motion.turning.norm();
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity(), pose = step;
    step.translation() = dt * motion.velocity;
    if (angle != 0)
        step.linear() = Eigen::AngleAxisd(angle, motion.turning.normalized()).toRotationMatrix();
    for (int i = 0; i < kSteps; ++i) pose = pose * step;
    return pose;
}

TEST(Deskew, TheMotionOfAnIncrementLeadsThereInItsTime) {
    const Eigen::Isometry3d increment = poseAt(1.5, -0.2, 0.05, 0.1, -0.03, 0.02);
    const Twist motion = Twist::of(increment, 0.25);
    EXPECT_LT(test::metresBetween(poseAfter(motion, 0.25), increment), 1e-4);
    const Twist straight = Twist::of(poseAt(2, 0, 0, 0, 0, 0), 0.5);
    EXPECT_NEAR(straight.velocity.x(), 4, 1e-12);
    EXPECT_EQ(straight.turning.norm(), 0);
}

TEST(Deskew, PointsComeToWhereTheyAreSeenFromAtTheStamp) {
    test::Noise noise;
    for (const Eigen::Isometry3d& increment :
         {poseAt(2.5, 0.1, 0.02, 0.12, 0.02, -0.01), poseAt(1, 0, 0, 0, 0, 0),
          poseAt(0, 0, 0, 0.3, 0, 0)}) {
        const Twist motion = Twist::of(increment, 0.1);
        Eigen::Matrix3Xf seen(3, 50), expected(3, 50);
        std::vector<float> times_s;
        for (Eigen::Index i = 0; i < seen.cols(); ++i) {
            times_s.push_back(static_cast<float>(0.05 * noise.uniform()));
            seen.col(i) = (30 * noise.direction()).cast<float>();
            const Eigen::Isometry3d pose = poseAfter(motion, double{times_s.back()});
            const Eigen::Vector3d there = pose * seen.col(i).cast<double>();
            expected.col(i) = there.cast<float>();
        }
        EXPECT_LT((odometry::deskew(seen, times_s, motion) - expected).cwiseAbs().maxCoeff(), 1e-4);
    }
}

TEST(Deskew, AzimuthTellsTheTimeOfASweepThatTurnsClockwiseFromTheBack) {
    Eigen::Matrix3Xf points(3, 5);
    points << 9, 0, 0, -9, -9,      // front, left, right, back coming from either side
        0, 9, -9, 0.001F, -0.001F,  //
        1, -2, 0, 3, 3;
    const auto times_s = odometry::azimuthTimes(points, 0.1);
    const float expected[] = {0, -0.025F, 0.025F, -0.05F, 0.05F};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(times_s[i], expected[i], 1e-4) << i;
}
}  // namespace
