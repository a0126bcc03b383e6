#include "odometry/spin_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "odometry/rings.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {

test::RingScan scanOfRings(unsigned rings) {
    test::Noise noise;
    return test::ringScan(test::yard(), test::poseAt(2, 1, 0, 0.3), {rings, 900, -20, 10, 0.02},
                          noise);
}

Eigen::Matrix3f turnOf(const Eigen::Vector3d& axis, double degrees) {
    return test::rotationAbout(axis.normalized(), degrees).cast<float>();
}

Eigen::Matrix3Xf shuffled(const Eigen::Matrix3Xf& points) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(points.cols()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    return points(Eigen::all, order);
}

TEST(SpinAxis, IsFoundInAnyAxesAndOrder) {
    for (const unsigned rings : {16U, 64U}) {
        const auto points = scanOfRings(rings).points;
        for (const auto& turn : {turnOf({0, 1, 0}, 25), turnOf({1, 0, 0}, 90),
                                 turnOf({1, 2, 3}, 70), turnOf({0, 0, 1}, 40)}) {
            const Eigen::Vector3d truth = turn.cast<double>().col(2);
            for (const auto& cloud : {Eigen::Matrix3Xf(turn * points), shuffled(turn * points)}) {
                const auto axis = odometry::spinAxisOf(cloud);
                ASSERT_TRUE(axis);
                EXPECT_LT(axis->cross(truth).norm(), 1e-3);  // either way along it
                EXPECT_NEAR(axis->norm(), 1, 1e-12);
            }
        }
    }
}

// Rings are told about the axis as they are about a sensor's own z.
TEST(SpinAxis, TurnedScansHaveTheirRings) {
    const auto scan = scanOfRings(64);
    const Eigen::Matrix3Xf turned = turnOf({0, 1, 0}, 25) * scan.points;
    const auto upright = odometry::uprightOf(turned);
    ASSERT_TRUE(upright);
    EXPECT_EQ(odometry::ringsOf(*upright * turned), scan.rings);
    EXPECT_NE(odometry::ringsOf(turned), scan.rings);
}

TEST(SpinAxis, AnUprightSensorIsLeftAsItIs) {
    const auto upright = odometry::uprightOf(scanOfRings(32).points);
    ASSERT_TRUE(upright);
    EXPECT_EQ(*upright, Eigen::Matrix3f::Identity());
}

TEST(SpinAxis, WhatDoesNotSpinHasNone) {
    EXPECT_FALSE(odometry::spinAxisOf(Eigen::Matrix3Xf(3, 0)));
    EXPECT_FALSE(odometry::spinAxisOf(scanOfRings(16).points.leftCols(50)));
    test::Noise noise;
    Eigen::Matrix3Xf anywhere(3, 20000);
    for (Eigen::Index i = 0; i < anywhere.cols(); ++i)
        anywhere.col(i) = 10 * noise.direction().cast<float>();
    EXPECT_FALSE(odometry::spinAxisOf(anywhere));
    EXPECT_FALSE(odometry::uprightOf(anywhere));
}
}  // namespace
