#include <gtest/gtest.h>

#include <vector>

#include "delio/slam/options.h"
#include "odometry/pipeline.h"
#include "poses.h"
#include "ring_scan.h"

using namespace delio;

namespace {
using Eigen::Isometry3d;

constexpr std::size_t kLost = 10, kFound = 13, kScans = 26;

/** Half a metre a scan. While nothing useful is seen, the vehicle turns by 20 deg. */
Isometry3d truthAt(std::size_t i) {
    const double x = 0.5 * static_cast<double>(i);
    return test::poseAt(x, 0, 0, i < kFound ? 0 : 0.35);
}

/** A ball that hangs above the sensor, of points that are never the same. */
Eigen::Matrix3Xf ball(test::Noise& noise) {
    constexpr Eigen::Index kPoints = 20000;
    constexpr double kRadius_m = 8;
    Eigen::Matrix3Xf points(3, kPoints);
    for (Eigen::Index i = 0; i < kPoints; ++i)
        points.col(i) = (Eigen::Vector3d(0, 0, 20) + kRadius_m * noise.direction()).cast<float>();
    return points;
}

Scan scanAt(std::size_t i, test::Noise& noise) {
    const bool isCovered = i >= kLost && i < kFound;
    Scan scan = test::scanOf(
        isCovered ? ball(noise)
                  : ringScan(test::yard(), truthAt(i), {48, 900, -24, 8, 0.01}, noise).points);
    scan.stamp_s = 0.1 * static_cast<double>(i);
    return scan;
}

// The map that begins after the loss is placed by a prediction. As soon as scans are found in the
// map before it, that one is used again, and the poses since are corrected.
TEST(PlaneOdometry, TakesTheMapAgainThatItLeftWhenItWasLost) {
    constexpr double kNear_m = 0.05, kNear_deg = 0.3;
    constexpr std::size_t kNewMap =
        kFound + 2;  // three scans in a row are not found in the old one
    test::Noise noise;
    odometry::PlaneOdometry odometry(Options::ofProfile("accurate").planes);
    std::vector<Isometry3d> poses;
    bool wasLost = false, isCorrected = false;
    std::size_t latestTrack = 0, track = 0;
    for (std::size_t i = 0; i < kScans; ++i) {
        const Step step = odometry.process(scanAt(i, noise));
        poses.push_back(i == 0 ? Isometry3d::Identity() : poses.back() * step.increment.pose);
        for (const auto& [scansAgo, pose, registered, inPlace] : step.corrected) {
            ASSERT_LE(scansAgo, i);
            EXPECT_GE(i - scansAgo, kLost) << "an earlier scan was corrected";
            poses[i - scansAgo] = poses[i] * pose;
        }
        wasLost = wasLost || step.lost;
        isCorrected = isCorrected || (wasLost && !step.corrected.empty());
        track = step.track;
        latestTrack = std::max(latestTrack, track);
    }
    EXPECT_TRUE(wasLost);
    EXPECT_TRUE(isCorrected);
    EXPECT_GT(latestTrack, 0U) << "a new map began";
    EXPECT_EQ(track, 0U) << "the earlier map was found again";
    for (std::size_t i = 0; i < kScans; ++i) {
        if (i >= kLost && i < kNewMap) continue;  // predicted
        EXPECT_LT(test::metresBetween(poses[i], truthAt(i)), kNear_m) << i;
        EXPECT_LT(test::degreesBetween(poses[i], truthAt(i)), kNear_deg) << i;
    }
}
}  // namespace
