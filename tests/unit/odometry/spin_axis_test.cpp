#include "odometry/spin_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "odometry/rings.h"
#include "ring_scan.h"
#include "rosette.h"

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

/** Points of a tenth of a second along beams. */
template <typename Beam>
Eigen::Matrix3Xf patternOf(double begin_s, const Beam& beam) {
    constexpr int kPoints = 24000, kLines = 6;
    Eigen::Matrix3Xf points(3, kPoints);
    const Eigen::Isometry3d pose = test::rosettePose(begin_s);
    for (int i = 0; i < kPoints; ++i) {
        const double t = begin_s + 0.1 * (i - i % kLines) / kPoints;
        const Eigen::Vector3d ray = beam(t, i % kLines);
        const double range = test::rosetteRange(pose.translation(), pose.linear() * ray);
        points.col(i) = (range * ray).cast<float>();
    }
    return points;
}

Eigen::Vector3d rayAt(double azimuth, double elevation) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// Livox: rosettes, figures of Lissajous, and a mirror that turns while it nods.
TEST(SpinAxis, PatternsThatDoNotRepeatHaveNone) {
    for (const double begin_s : {0.0, 1.3, 2.6}) {
        EXPECT_FALSE(spinAxisOf(patternOf(begin_s, test::rosetteBeam)));
        EXPECT_FALSE(spinAxisOf(patternOf(begin_s, [](double t, int line) {
            return rayAt(0.7 * std::sin(2 * M_PI * 97.3 * t),
                         0.2 * std::sin(2 * M_PI * 151.7 * t) + 0.003 * line);
        })));
        EXPECT_FALSE(spinAxisOf(patternOf(begin_s, [](double t, int line) {
            return rayAt(2 * M_PI * 200.3 * t,
                         0.4 + 0.5 * std::sin(2 * M_PI * 20.7 * t + 0.3 * line));
        })));
    }
}

/** Azimuths that rise evenly through a turn of `period_s`. */
std::vector<float> timesOf(const Eigen::Matrix3Xf& points, double period_s) {
    std::vector<float> times_s;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        times_s.push_back(static_cast<float>(
            period_s *
            (0.5 + std::atan2(double{points(1, i)}, double{points(0, i)}) / (2 * M_PI))));
    return times_s;
}

TEST(TurnPeriod, IsSeenInAnyAxesAndWhereASectorIsMissing) {
    const Eigen::Matrix3Xf points = scanOfRings(32).points;
    for (const double period_s : {0.05, 0.1}) {
        const auto times_s = timesOf(points, period_s);
        const auto whole = turnPeriodOf(turnOf({1, 2, 3}, 70) * points, times_s);
        ASSERT_TRUE(whole);
        EXPECT_NEAR(*whole, period_s, 0.01 * period_s);
        std::vector<Eigen::Index> seen;
        std::vector<float> timesOfSeen;
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            if (points(0, i) < 0 && std::abs(points(1, i)) < -points(0, i)) continue;  // 90 deg
            seen.push_back(i);
            timesOfSeen.push_back(times_s[static_cast<std::size_t>(i)]);
        }
        const auto part = turnPeriodOf(points(Eigen::all, seen), timesOfSeen);
        ASSERT_TRUE(part);
        EXPECT_NEAR(*part, period_s, 0.01 * period_s);
    }
}

TEST(TurnPeriod, NothingSpinsWithoutOrder) {
    const Eigen::Matrix3Xf points = scanOfRings(32).points;
    auto times_s = timesOf(points, 0.1);
    std::shuffle(times_s.begin(), times_s.end(), std::mt19937(1));
    EXPECT_FALSE(turnPeriodOf(points, times_s));
    EXPECT_FALSE(turnPeriodOf(points, std::vector<float>(times_s.size(), 0.0F)));
    EXPECT_FALSE(turnPeriodOf(patternOf(0, test::rosetteBeam), std::vector<float>(24000, 0.0F)));
}

/** What a sensor sees that is tilted by `degrees` about `axis`. */
Eigen::Matrix3Xf tiltedScan(const Eigen::Vector3d& axis, double degrees, unsigned rings,
                            const test::Scene& scene = test::yard()) {
    test::Noise noise;
    Eigen::Isometry3d pose = test::poseAt(2, 1, 0, 0.3);
    pose.linear() *= test::rotationAbout(axis.normalized(), degrees);
    return test::ringScan(scene, pose, {rings, 900, -15, 15, 0.02}, noise).points;
}

TEST(Upright, TheGroundSaysHowASensorIsTilted) {
    for (const unsigned rings : {16U, 64U})
        for (const double degrees : {15.0, 30.0, 45.0})
            for (const Eigen::Vector3d& axis :
                 {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 1, 0)}) {
                const Eigen::Matrix3d tilt = test::rotationAbout(axis.normalized(), degrees);
                const Eigen::Matrix3f upright = odometry::uprightOf(
                    Eigen::Isometry3d::Identity(), tiltedScan(axis, degrees, rings));
                const Eigen::Vector3d up = upright.row(2).transpose().cast<double>();
                EXPECT_LT(up.cross(tilt.row(2).transpose()).norm(), 0.02)
                    << rings << " rings, " << degrees << " deg";
            }
}

TEST(Upright, WithoutATiltedGroundTheSpinAxisSays) {
    for (const auto& scene : {test::yard(), test::room(), test::corridor()}) {
        const auto points = tiltedScan({0, 1, 0}, 0, 32, scene);
        EXPECT_EQ(odometry::uprightOf(Eigen::Isometry3d::Identity(), points),
                  Eigen::Matrix3f::Identity());
    }
}

// The mounting that a source knows is not doubted.
TEST(Upright, ThePoseOnTheVehicleComesFirst) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = test::rotationAbout({0, 1, 0}, 20);
    const auto upright = odometry::uprightOf(pose, tiltedScan({0, 1, 0}, 35, 32));
    EXPECT_LT((upright.row(2).cast<double>() - pose.linear().row(2)).norm(), 1e-6);
}
}  // namespace
