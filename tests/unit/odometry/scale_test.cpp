#include "odometry/preprocess.h"
#include "odometry/tuning.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {

Scan sphere(float radius, Eigen::Index count) {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, count);
    for (Eigen::Index i = 0; i < count; ++i)
        points.col(i) = radius * noise.direction().cast<float>();
    return test::scanOf(points);
}

TEST(Scale, FollowsThePlace) {
    EXPECT_EQ(scaleOf(sphere(40, 1000)), 1);
    EXPECT_NEAR(scaleOf(sphere(8, 1000)), 0.5, 1e-6);
    EXPECT_EQ(scaleOf(sphere(1, 1000)), 0.25);
    EXPECT_EQ(scaleOf(sphere(1, 0)), 1);
}

TEST(Scale, LengthsOfThePlaceAreMultiplied) {
    const PlaneOdometryOptions options;
    const auto half = atScale(options, 0.5);
    EXPECT_EQ(half.map.voxel_size, options.map.voxel_size / 2);
    EXPECT_EQ(half.spacing.point_spacing, SpacingTuning().point_spacing / 2);
    EXPECT_EQ(half.scan.max_range, options.scan.max_range);  // the sensor's
    EXPECT_EQ(half.localMap.point_sigma, LocalMapTuning().point_sigma);
    EXPECT_EQ(half.localMap.probe, LocalMapTuning().probe / 2);
    EXPECT_NO_THROW(atScale(options, 0.25).points.check("point_registration"));
}
}  // namespace
