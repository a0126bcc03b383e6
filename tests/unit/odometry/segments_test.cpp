#include "odometry/dynamic_objects.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::Segment;

Eigen::Matrix3Xf seen(const test::Scene& things,
                      const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    test::Noise noise;
    test::Scene scene = {{{-200, -200, -3}, {200, 200, -1.8}}};
    scene.insert(scene.end(), things.begin(), things.end());
    return ringScan(scene, pose, {64, 1800, -24, 8, 0.02}, noise).points;
}

TEST(Segments, ThingsThatStandApartAreOneSegmentEach) {
    const auto segments = segmentsOf(
        seen({{{6, -1, -1.8}, {10, 1, 0.5}}, {{6, 3, -1.8}, {10, 5, 0.5}}}), SegmentTuning{});
    ASSERT_EQ(segments.size(), 2U);
    for (const Segment& segment : segments) {
        EXPECT_GT(segment.points.size(), 200U);
        EXPECT_NEAR(segment.box.min().x(), 6, 0.15);
        EXPECT_NEAR(segment.box.max().z(), 0.5, 0.15);
        EXPECT_GT(segment.box.min().z(), -1.8 + 0.2);  // without the ground
        EXPECT_NEAR(segment.box.sizes().y(), 2, 0.2);
    }
}

TEST(Segments, GroundIsNoneAlsoWhereItSlopes) {
    EXPECT_TRUE(segmentsOf(seen({}), SegmentTuning{}).empty());
    const Eigen::Isometry3d tilted = test::poseAtDeg(0, 0, 0, 0, 5);
    EXPECT_TRUE(segmentsOf(seen({}, tilted), SegmentTuning{}).empty());
}

TEST(Segments, WhatIsLongHighFarOrNearlyUnseenIsLeftOut) {
    EXPECT_TRUE(segmentsOf(seen({{{-10, 5, -1.8}, {10, 6, 0.5}}}), SegmentTuning{}).empty());
    const test::Block box{{12, -1, -1.8}, {14, 1, -0.2}};
    EXPECT_EQ(segmentsOf(seen({box}), SegmentTuning{}).size(), 1U);
    SegmentTuning options;
    options.radius = 10;
    EXPECT_TRUE(segmentsOf(seen({box}), options).empty());
    options = {};
    options.min_points = 100000;
    EXPECT_TRUE(segmentsOf(seen({box}), options).empty());
    // Of a sign over the road only what is low enough.
    EXPECT_TRUE(segmentsOf(seen({{{12, -1, 1.3}, {12.2, 1, 1.6}}}), SegmentTuning{}).empty());
}

TEST(Segments, NoPointsNoSegments) {
    EXPECT_TRUE(segmentsOf(Eigen::Matrix3Xf(3, 0), SegmentTuning{}).empty());
}
}  // namespace
