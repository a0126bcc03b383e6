#include "odometry/preprocess.h"

#include <gtest/gtest.h>
#include <mrpt/core/bits_math.h>

#include <cmath>
#include <limits>

#include "odometry/tuning.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::preprocess;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

double elevation(const Eigen::Vector3d& p) { return std::atan2(p.z(), p.head<2>().norm()); }

TEST(Preprocess, WhatIsNotFiniteIsDroppedAndCounted) {
    Eigen::Matrix3Xf points(3, 7);
    points << 10, kNaN, 0, 0, kInf, 0, 20,  //
        1, 5, kNaN, 5, 5, -kInf, 2,         //
        -1, 5, 5, kNaN, 5, 5, 3;
    const auto cloud = preprocess(test::scanOf(points), {});
    EXPECT_EQ(cloud.notFinite, 5U);
    EXPECT_EQ(cloud.outOfRange, 0U);
    ASSERT_EQ(cloud.points.cols(), 2);
    EXPECT_EQ(cloud.points.col(0), points.col(0));  // in the sensor's order, to the bit
    EXPECT_EQ(cloud.points.col(1), points.col(6));
    EXPECT_EQ(odometry::neighbouringRings(cloud).size(), 2U);
}

TEST(Preprocess, SaysWhyNoPointIsLeft) {
    const auto why = [](float x, float y) {
        Eigen::Matrix3Xf points(3, 2);
        points << x, x, y, 2 * y, 0, 0;
        return odometry::whyNoneIsLeft(test::scanOf(points), {});
    };
    EXPECT_EQ(why(10, 1), "");
    EXPECT_EQ(odometry::whyNoneIsLeft(test::scanOf(Eigen::Matrix3Xf(3, 0)), {}), "no points");
    EXPECT_EQ(why(431200, 4599850),
              "all 2 points are farther than scan.max_range (the nearest: 4.62e+06 m): are they in "
              "metres and relative to the sensor?");
    EXPECT_NE(why(0.02F, 0.01F).find("nearer than scan.min_range (the farthest: 0.0283 m)"),
              std::string::npos);
    EXPECT_EQ(why(0, 0), "all 2 points are NaN or at the sensor");
    EXPECT_EQ(why(kNaN, 3), "all 2 points are NaN or at the sensor");
    EXPECT_NE(why(0.5F, 2000).find("farther"), std::string::npos);
    Eigen::Matrix3Xf apart(3, 2);
    apart << 1, 200, 0, 0, 0, 0;
    EXPECT_EQ(odometry::whyNoneIsLeft(test::scanOf(apart), {}),
              "none of the 2 points lies between scan.min_range and scan.max_range and has a time");
}

TEST(Preprocess, PointsWithoutATimeAreDroppedWhereTimesCount) {
    Eigen::Matrix3Xf points(3, 3);
    points << 10, 20, 30, 1, 2, 3, 0, 0, 0;
    Scan scan = test::scanOf(points);
    scan.times_s = {0.01F, kNaN, -0.02F};
    const auto cloud = preprocess(scan, {});
    EXPECT_EQ(cloud.notFinite, 1U);
    EXPECT_EQ(cloud.times_s, (std::vector<float>{0.01F, -0.02F}));
    EXPECT_EQ(cloud.indices, (std::vector<std::uint32_t>{0, 2}));
    PreprocessOptions options;
    options.deskew = false;
    EXPECT_EQ(preprocess(scan, options).points.cols(), 3);
}

TEST(Preprocess, TimesBeyondASecondAreNoTimes) {
    Eigen::Matrix3Xf points(3, 3);
    points << 10, 20, 30, 1, 2, 3, 0, 0, 0;
    Scan scan = test::scanOf(points);
    scan.times_s = {1e9F, 0.01F, -1.5F};
    const auto cloud = preprocess(scan, {});
    EXPECT_EQ(cloud.notFinite, 2U);
    EXPECT_EQ(cloud.times_s, std::vector<float>{0.01F});
}

TEST(Preprocess, APointAtTheSensorHasNoDirection) {
    PreprocessOptions options;
    options.min_range = 0;
    Eigen::Matrix3Xf points(3, 2);
    points << 0, 0.1F, 0, 0, 0, 0;
    EXPECT_EQ(preprocess(test::scanOf(points), options).points.cols(), 1);
}

TEST(Preprocess, WhatIsOutOfRangeIsDroppedAndCounted) {
    PreprocessOptions options;
    options.min_range = 2;
    options.max_range = 5;
    Eigen::Matrix3Xf points(3, 8);
    points << 2, 1.99F, 3, 3, 0, 0, -4, 1e30F,  //
        0, 0, 4, 4, 0, 0, 0, 1e30F,             //
        0, 0, 0, 0.2F, 0, -4.5F, 0, 0;
    const auto cloud = preprocess(test::scanOf(points), options);
    EXPECT_EQ(cloud.outOfRange, 4U);  // 1.99 m, 5.004 m, the origin, and 1.4e30 m
    EXPECT_EQ(cloud.notFinite, 0U);
    ASSERT_EQ(cloud.points.cols(), 4);
    EXPECT_EQ(cloud.points.col(1), points.col(2));
    EXPECT_EQ(cloud.points.col(2), points.col(5));
}

TEST(Preprocess, VerticalCorrectionRaisesTheElevationAndNothingElse) {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, 500);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        Eigen::Vector3d ray = noise.direction();
        ray.z() /= 2;  // a LiDAR does not look along its axis
        points.col(i) = ((40 + 35 * noise.uniform()) * ray.normalized()).cast<float>();
    }
    for (const double degrees : {0.205, -1.5}) {
        PreprocessOptions options;
        options.vertical_correction_deg = degrees;
        const auto cloud = preprocess(test::scanOf(points), options);
        ASSERT_EQ(cloud.points.cols(), points.cols());
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const Eigen::Vector3d before = points.col(i).cast<double>(),
                                  after = cloud.points.col(i).cast<double>();
            // Floats have 7 digits.
            EXPECT_NEAR(mrpt::RAD2DEG(elevation(after) - elevation(before)), degrees, 3e-5);
            EXPECT_NEAR(after.norm() / before.norm(), 1, 1e-6);
            EXPECT_NEAR(std::atan2(after.y(), after.x()), std::atan2(before.y(), before.x()), 1e-6);
        }
    }
}

TEST(Preprocess, APointAboveTheSensorHasNoAzimuthToKeep) {
    PreprocessOptions options;
    options.vertical_correction_deg = 0.205;
    const auto cloud = preprocess(test::scanOf(Eigen::Vector3f(0, 0, 10)), options);
    ASSERT_EQ(cloud.points.cols(), 1);
    EXPECT_TRUE(cloud.points.allFinite());
}

TEST(Preprocess, RingsThatTheSourceKnowsStayWithTheirPoints) {
    Eigen::Matrix3Xf points(3, 4);
    points << 10, kNaN, 0.1F, 20, 1, 5, 0, 2, -1, 5, 0, 3;
    Scan scan = test::scanOf(points);
    scan.rings = {7, 8, 9, 63};
    // Numbered from the top: the second of the points that are kept is the higher one.
    const auto cloud = preprocess(scan, {});
    EXPECT_EQ(cloud.rings, (std::vector<std::uint16_t>{7, 63}));
    EXPECT_EQ(odometry::neighbouringRings(cloud), (std::vector<std::uint16_t>{1, 0}));
}

TEST(Preprocess, RingsAreFoundWhereTheSourceDoesNotKnow) {
    test::Noise noise;
    const auto made = test::ringScan(test::yard(), Eigen::Isometry3d::Identity(), {}, noise);
    const auto cloud = preprocess(test::scanOf(made.points), {});
    ASSERT_EQ(cloud.points.cols(), made.points.cols());  // nothing is near or far in the yard
    EXPECT_TRUE(cloud.rings.empty());
    EXPECT_EQ(odometry::neighbouringRings(cloud), made.rings);
}

TEST(Preprocess, AnEmptyScanStaysEmpty) {
    const auto cloud = preprocess(test::scanOf({}), {});
    EXPECT_EQ(cloud.points.cols(), 0);
    EXPECT_TRUE(cloud.rings.empty());
    EXPECT_TRUE(odometry::neighbouringRings(cloud).empty());
    const auto none = preprocess(test::scanOf(Eigen::Vector3f(kNaN, 0, 0)), {});
    EXPECT_EQ(none.points.cols(), 0);
    EXPECT_EQ(none.notFinite, 1U);
}

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
