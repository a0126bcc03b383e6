#include "odometry/wheel_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "delio/core/geometry.h"

namespace delio::odometry {
namespace {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kScan_s = 0.1, kSample_s = 0.02;

Matrix3d yawed(double rad) {
    const Eigen::AngleAxisd turn(rad, Vector3d::UnitZ());
    return turn.toRotationMatrix();
}

/** A car at 10 m/s, which turns left and right, with wheels and a LiDAR in the middle of its roof.
 */
struct Car {
    double scale = 1;                                          //!< of the wheels' distances
    Isometry3d lidar = isometry(yawed(0.5), {1.5, 0.2, 1.8});  //!< in the vehicle
    /** Factor of the wheels' distances at a time. */
    std::function<double(double)> slip = [](double) { return 1; };
    /** Damage to a sample; false: it is lost. */
    std::function<bool(double, OdometrySample&)> spoil = [](double, OdometrySample&) {
        return true;
    };

    WheelPrior wheels{};
    std::mt19937 random{7};
    Isometry3d told = Isometry3d::Identity();  //!< by the wheels
    std::size_t samples = 0, scans = 0;

    /** Vehicle to world, along arcs of changing curvature. */
    static Isometry3d at(double time_s) {
        constexpr double kStep_s = 1e-3, kSpeed_mps = 10;
        double x = 0, y = 0;
        const auto yaw = [](double s) { return 0.3 * std::sin(0.4 * s); };
        for (int i = 0; i < std::lround(time_s / kStep_s); ++i) {
            const double middle_s = (i + 0.5) * kStep_s;
            x += kSpeed_mps * kStep_s * std::cos(yaw(middle_s));
            y += kSpeed_mps * kStep_s * std::sin(yaw(middle_s));
        }
        return isometry(yawed(yaw(time_s)), {x, y, 0});
    }
    Isometry3d lidarAt(double time_s) const { return at(time_s) * lidar; }

    void addUntil(double time_s) {
        for (; kSample_s * static_cast<double>(samples) <= time_s; ++samples) {
            const double now_s = kSample_s * static_cast<double>(samples);
            if (samples > 0) {
                Isometry3d moved = at(now_s - kSample_s).inverse() * at(now_s);
                moved.translation() *= scale * slip(now_s);
                told = told * moved;
            }
            OdometrySample sample;
            sample.stamp_s = now_s;
            sample.pose = told;
            if (spoil(now_s, sample)) wheels.add(sample);
        }
    }

    /** Scans that show every axis, with 1 cm of noise. */
    void drive(double to_s, bool isObserved = true) {
        std::normal_distribution<double> noise(0, 0.005);
        for (; kScan_s * static_cast<double>(scans) < to_s; ++scans) {
            const double now_s = kScan_s * static_cast<double>(scans);
            addUntil(now_s + kSample_s);
            wheels.advance({now_s, now_s, 0}, lidar);
            wheels.count(now_s, false);
            if (scans == 0 || !isObserved) continue;
            Isometry3d moved = lidarAt(now_s - kScan_s).inverse() * lidarAt(now_s);
            moved.translation() += Vector3d(noise(random), noise(random), noise(random));
            wheels.observe(now_s - kScan_s, now_s, moved);
        }
    }
    double latest_s() const { return kScan_s * static_cast<double>(scans - 1); }

    /** Error of the LiDAR's translation over the latest interval. */
    double error_m() const {
        const double to_s = latest_s(), from_s = to_s - kScan_s;
        const Isometry3d moved = lidarAt(from_s).inverse() * lidarAt(to_s);
        const auto step = wheels.between(from_s, to_s);
        if (!step) return INFINITY;
        return (step->translation(moved.linear()) - moved.translation()).norm();
    }
};

TEST(WheelPrior, GivesTheLidarsMotionAcrossALeverArm) {
    Car car;
    car.drive(1, false);
    EXPECT_LT(car.error_m(), 1e-3);
    EXPECT_TRUE(car.wheels.isPossibleAt(1));
    EXPECT_FALSE(car.wheels.isTrustedAt(1));
}

TEST(WheelPrior, SamplesOfAnotherClockAreNamed) {
    for (const double offset_s : {-5000.0, 5000.0}) {
        Car car;
        car.spoil = [&](double, OdometrySample& sample) {
            sample.stamp_s += offset_s;
            return true;
        };
        car.drive(5);
        const auto report = car.wheels.report();
        ASSERT_TRUE(report) << offset_s;
        ASSERT_EQ(report->findings.size(), 1U) << offset_s;
        EXPECT_NE(report->findings.front().find("none of its samples lies between two scans"),
                  std::string::npos)
            << report->findings.front();
    }
}

TEST(WheelPrior, LearnsTheScaleAndHowWellItAgrees) {
    Car car;
    car.scale = 1.04;
    car.drive(12);
    const auto report = car.wheels.report();
    ASSERT_TRUE(report);
    EXPECT_TRUE(car.wheels.isTrustedAt(12));
    EXPECT_NEAR(report->scale, 1 / 1.04, 0.002);
    ASSERT_TRUE(report->sigma);
    EXPECT_LT(*report->sigma, 0.01);
    EXPECT_GT(*report->sigma, 0.001);
    EXPECT_EQ(report->contradicting, 0U);
    EXPECT_LT(car.error_m(), 0.005);
}

TEST(WheelPrior, IsNotUsedOnceItSlipsAndIsUsedAgainLater) {
    Car car;
    car.slip = [](double time_s) { return time_s > 8 && time_s < 11 ? 1.1 : 1; };
    car.drive(8);
    EXPECT_TRUE(car.wheels.isTrustedAt(car.latest_s()));
    car.drive(8.6);
    EXPECT_FALSE(car.wheels.isTrustedAt(car.latest_s()));
    EXPECT_FALSE(car.wheels.isPossibleAt(car.latest_s()));
    car.drive(11);
    EXPECT_FALSE(car.wheels.isTrustedAt(car.latest_s()));
    car.drive(15);
    EXPECT_TRUE(car.wheels.isTrustedAt(car.latest_s()));
    EXPECT_NEAR(car.wheels.report()->scale, 1, 0.002);
    EXPECT_EQ(car.wheels.report()->findings.size(), 1U);
}

TEST(WheelPrior, LeavesOutAJumpOfItsFrame) {
    Car car;
    car.spoil = [](double time_s, OdometrySample& sample) {
        if (time_s > 6.05) sample.pose = isometry(yawed(2), Vector3d(100, -20, 0)) * sample.pose;
        return true;
    };
    car.drive(6.15);
    EXPECT_FALSE(car.wheels.between(6, 6.1));
    car.drive(9);
    EXPECT_LT(car.error_m(), 0.005);
    EXPECT_TRUE(car.wheels.isTrustedAt(car.latest_s()));
    const auto report = car.wheels.report();
    EXPECT_EQ(report->jumps, 1U);
    EXPECT_EQ(report->contradicting, 0U);
}

TEST(WheelPrior, SaysThatItsUnitIsAnother) {
    Car car;
    car.scale = 3.6;
    car.drive(10);
    EXPECT_FALSE(car.wheels.isPossibleAt(car.latest_s()));
    const auto report = car.wheels.report();
    ASSERT_EQ(report->findings.size(), 1U);
    EXPECT_NE(report->findings.front().find("0.278 times"), std::string::npos)
        << report->findings.front();
}

TEST(WheelPrior, HasNothingForAGap) {
    Car car;
    car.spoil = [](double time_s, OdometrySample&) { return time_s < 4 || time_s > 5.5; };
    car.drive(5);
    EXPECT_EQ(car.error_m(), INFINITY);
    car.drive(7);
    EXPECT_LT(car.error_m(), 0.005);
    EXPECT_GT(car.wheels.report()->scansWithout, 10U);
    EXPECT_EQ(car.wheels.report()->jumps, 0U);
}

TEST(WheelPrior, UsesSamplesByTheirStamps) {
    Car ordered, mixed;
    std::vector<OdometrySample> held;
    mixed.spoil = [&](double, OdometrySample& sample) {
        held.push_back(sample);
        if (held.size() < 2) return false;
        mixed.wheels.add(held[1]);
        mixed.wheels.add(held[0]);
        held.clear();
        return false;
    };
    mixed.addUntil(4);
    ordered.drive(3);
    mixed.drive(3);
    EXPECT_EQ(ordered.error_m(), mixed.error_m());
    EXPECT_EQ(mixed.wheels.report()->dropped, 0U);
}
}  // namespace
}  // namespace delio::odometry
