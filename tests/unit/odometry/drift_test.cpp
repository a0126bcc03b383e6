#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "delio/slam/options.h"
#include "odometry/pipeline.h"
#include "poses.h"
#include "ring_scan.h"

using namespace delio;

namespace {
using Eigen::Isometry3d;

constexpr std::size_t kScans = 26;
constexpr double kStep_m = 1, kSight_m = 12;

Isometry3d truthAt(std::size_t i) { return test::poseAt(kStep_m * static_cast<double>(i), 0, 0); }

/** A road between two smooth walls that leads, 9 m ahead, past blocks of many sizes. */
test::Scene outOfATunnel() {
    constexpr double kEnd_m = 9, kFar_m = 100, kWall_m = 4, kGround_m = -1.8;
    test::Scene scene{{{-kFar_m, -kFar_m, -5}, {kFar_m, kFar_m, kGround_m}},
                      {{-kFar_m, kWall_m, kGround_m}, {kEnd_m, kWall_m + 1, 6}},
                      {{-kFar_m, -kWall_m - 1, kGround_m}, {kEnd_m, -kWall_m, 6}}};
    test::Noise noise(3);
    for (double x = kEnd_m + 1; x < 60; x += 3 + noise.uniform())
        for (const double side : {-1.0, 1.0}) {
            const double near = 5 + noise.uniform(), height = 2 + 1.5 * noise.uniform();
            const Eigen::Vector3d low(x, side > 0 ? near : -near - 2, kGround_m);
            scene.push_back({low, low + Eigen::Vector3d(1.2 + noise.uniform(), 2, height)});
        }
    return scene;
}

/** In fog. */
Scan scanAt(std::size_t i, test::Noise& noise) {
    const auto seen = ringScan(outOfATunnel(), truthAt(i), {48, 900, -24, 8, 0.01}, noise).points;
    Eigen::Matrix3Xf points(3, seen.cols());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < seen.cols(); ++k)
        if (seen.col(k).norm() < kSight_m) points.col(count++) = seen.col(k);
    Scan scan = test::scanOf(points.leftCols(count));
    scan.stamp_s = 0.1 * static_cast<double>(i);
    return scan;
}

// Between the walls the sensor seems to stand. Where the map that began there is out of sight, a
// new one begins. As soon as the motion is known, the scans before are registered again, backwards.
TEST(PlaneOdometry, AStartThatShowsNoMotionIsCorrectedOnceItIsKnown) {
    test::Noise noise;
    odometry::PlaneOdometry odometry(Options::ofProfile("accurate").planes);
    std::vector<Isometry3d> poses;
    std::vector<bool> lost;
    std::size_t newMaps = 0, track = 0, lostAtFirst = 0;
    for (std::size_t i = 0; i < kScans; ++i) {
        const Step step = odometry.process(scanAt(i, noise));
        poses.push_back(i == 0 ? Isometry3d::Identity() : poses.back() * step.increment.pose);
        lost.push_back(step.lost);
        lostAtFirst += step.lost;
        for (const auto& [scansAgo, pose, registered, inPlace] : step.corrected) {
            poses.at(i - scansAgo) = poses[i] * pose;
            if (registered) lost.at(i - scansAgo) = false;
        }
        newMaps += step.track > track;
        track = step.track;
    }
    EXPECT_EQ(newMaps, 1U);
    EXPECT_GT(lostAtFirst, 0U);
    EXPECT_EQ(std::count(lost.begin(), lost.end(), true), 0);
    EXPECT_EQ(track, 0U);
    for (std::size_t i = 0; i < kScans; ++i)
        EXPECT_LT(test::metresBetween(poses[i], truthAt(i)), 0.1) << i;
}
}  // namespace
