#include "slam/levelling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "delio/core/geometry.h"

namespace delio {
namespace {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDeg = M_PI / 180, kGravity_mps2 = 9.81, kScan_s = 0.1;

/** Sensor to level ground at a time. */
using Motion = std::function<Isometry3d(double)>;

Isometry3d standStill(double) { return Isometry3d::Identity(); }

/** 10 m/s along S bends, over a slope. */
Isometry3d weave(double time_s) {
    const double heading = 1.2 * std::sin(0.2 * time_s), pitch = 0.05 * std::sin(0.3 * time_s);
    Vector3d place(0, 0, 0);
    constexpr int kParts = 400;  // the way is the integral of the heading
    for (int i = 0; i < kParts; ++i) {
        const double t_s = time_s * (i + 0.5) / kParts;
        const double h = 1.2 * std::sin(0.2 * t_s);
        place += 10 * time_s / kParts * Vector3d(std::cos(h), std::sin(h), 0);
    }
    return isometry(rotationExp({0, 0, heading}) * rotationExp({0, pitch, 0}), place);
}

Vector3d accelerationOf(const Motion& motion, double time_s) {
    constexpr double kHalf_s = 5e-3;
    return (motion(time_s - kHalf_s).translation() + motion(time_s + kHalf_s).translation() -
            2 * motion(time_s).translation()) /
           (kHalf_s * kHalf_s);
}

Vector3d rateOf(const Motion& motion, double time_s) {
    constexpr double kHalf_s = 5e-4;
    return rotationLog(motion(time_s - kHalf_s).linear().transpose() *
                       motion(time_s + kHalf_s).linear()) /
           (2 * kHalf_s);
}

/** An IMU on a sensor, and the poses of scans. */
struct Drive {
    Motion motion = weave;
    double seconds = 40;
    Matrix3d mount = rotationExp({0.2, -0.3, 2});  //!< IMU to sensor
    Vector3d bias = Vector3d(0.05, -0.03, 0.02);   //!< m/s^2
    double unit = 1;                               //!< of accelerations, m/s^2
    double gravity_mps2 = kGravity_mps2;
    std::function<bool(double)> isMissing = [](double) { return false; };  //!< a sample
    Matrix3d mapTilt = rotationExp({0.1, 0.05, 0.3});  //!< level ground to the map
    Vector3d drift = Vector3d::Zero();                 //!< rad per scan
    double noise_m = 0;                                //!< of a pose
    std::vector<Isometry3d> truth{};                   //!< in the map

    ImuSample sampleAt(double time_s) const {
        const Matrix3d toImu = (motion(time_s).linear() * mount).transpose();
        ImuSample sample;
        sample.stamp_s = time_s;
        sample.rate_radps = mount.transpose() * rateOf(motion, time_s);
        sample.acceleration_mps2 =
            (toImu * (accelerationOf(motion, time_s) + gravity_mps2 * Vector3d::UnitZ()) + bias) /
            unit;
        return sample;
    }

    Levelled level(bool holdsTilt) {
        const graph::PoseGraphOptions options;
        SpecificForce force;
        ForcesOnTrack track;
        graph::PoseGraph graph;
        std::mt19937 random(5);
        std::normal_distribution<double> noise(0, noise_m);
        Isometry3d pose = isometry(mapTilt, Vector3d::Zero()) * motion(0), before = motion(0);
        double next_s = -0.3;
        for (double time_s = 0; time_s < seconds; time_s += kScan_s) {
            for (; next_s < time_s + 0.2; next_s += 0.005)
                if (!isMissing(next_s)) force.add(sampleAt(next_s));
            const Isometry3d now = motion(time_s);
            if (time_s > 0) pose = pose * before.inverse() * now * Isometry3d(rotationExp(drift));
            truth.push_back(isometry(mapTilt, Vector3d::Zero()) * now);
            before = now;
            force.addScan(time_s, Vector3d::Zero());
            track.stamps_s.push_back(time_s);
            track.usable.push_back(true);
            track.mounts.push_back(mount);
            Isometry3d measured = pose;
            measured.translation() += Vector3d(noise(random), noise(random), noise(random));
            const std::size_t node = graph.addNode(measured);
            if (node == 0) continue;
            Matrix6 covariance = Matrix6::Identity() * 0.01 * 0.01;
            covariance.bottomRightCorner<3, 3>() *= std::pow(0.0005 / 0.01, 2);
            graph.addEdge(
                {node - 1, node, {graph.poses()[node - 1].inverse() * measured, covariance}});
        }
        track.forces = force.take();
        return levelled(graph, track, holdsTilt ? &options : nullptr);
    }

    /** Angle between the vertical found and the true one, deg. */
    double off_deg(const Vector3d& up) const {
        return std::acos(std::min(1.0, up.dot(mapTilt * Vector3d::UnitZ()))) / kDeg;
    }

    /** The same of the last pose. */
    double tiltOff_deg(const graph::PoseGraph& graph) const {
        const Matrix3d &is = graph.poses().back().linear(), &was = truth.back().linear();
        const Vector3d up = mapTilt * Vector3d::UnitZ();
        return std::acos(std::min(1.0, (is.transpose() * up).dot(was.transpose() * up))) / kDeg;
    }
};
}  // namespace

TEST(SpecificForce, IsIntegratedAlongATurn) {
    // Turning about z at w with a constant force f in the moving axes: closed form.
    const double w = 0.8, duration_s = 0.1;
    const Vector3d f(2, 0, 9.81);
    SpecificForce force;
    for (double t_s = -0.05; t_s < 0.3; t_s += 0.005) {
        ImuSample sample;
        sample.stamp_s = t_s;
        sample.rate_radps = Vector3d(0, 0, w + 0.1);
        sample.acceleration_mps2 = f;
        force.add(sample);
    }
    for (const double stamp_s : {0.0, 0.0 + duration_s, 0.0 + 2 * duration_s})
        force.addScan(stamp_s, {0, 0, 0.1});
    const auto found = force.take();
    ASSERT_EQ(found.size(), 2u);
    ASSERT_TRUE(found[1]);
    const double turn = w * duration_s;
    const Vector3d once(2 * std::sin(turn) / w, 2 * (1 - std::cos(turn)) / w, 9.81 * duration_s);
    const Vector3d twice(2 * (1 - std::cos(turn)) / (w * w), 2 * (turn - std::sin(turn)) / (w * w),
                         9.81 * duration_s * duration_s / 2);
    EXPECT_NEAR((found[1]->once - once).norm(), 0, 1e-6);
    EXPECT_NEAR((found[1]->twice - twice).norm(), 0, 1e-7);
}

TEST(SpecificForce, IsMissingInAGap) {
    SpecificForce force;
    for (double t_s = -0.05; t_s < 0.6; t_s += 0.005) {
        if (t_s > 0.22 && t_s < 0.3) continue;
        ImuSample sample;
        sample.stamp_s = t_s;
        sample.rate_radps = Vector3d::Zero();
        sample.acceleration_mps2 = Vector3d(0, 0, 9.81);
        force.add(sample);
    }
    for (int i = 0; i <= 5; ++i) force.addScan(0.1 * i, Vector3d::Zero());
    const auto found = force.take();
    ASSERT_EQ(found.size(), 5u);
    for (const std::size_t i : {0, 1, 3, 4}) EXPECT_TRUE(found[i]) << i;
    EXPECT_FALSE(found[2]);
}

TEST(Levelling, FindsTheVerticalAndTheBias) {
    Drive drive;
    const auto found = drive.level(false);
    EXPECT_EQ(found.vertical.refusal, "");
    EXPECT_LT(drive.off_deg(found.vertical.up), 0.02);
    // Along the vertical, a bias is the same as a stronger gravity.
    const Vector3d vertical = drive.mount.transpose() * Vector3d::UnitZ();
    EXPECT_NEAR((found.vertical.bias_mps2 - drive.bias).cross(vertical).norm(), 0, 0.005);
    EXPECT_GE(found.vertical.stretches, 9u);
    EXPECT_FALSE(found.vertical.holdsTilt);
}

TEST(Levelling, SaysHowWellItKnowsTheVertical) {
    Drive drive;
    drive.motion = standStill;  // the bias does not show
    const auto found = drive.level(false);
    const double off_deg = drive.off_deg(found.vertical.up);
    EXPECT_NEAR(off_deg, std::hypot(0.05, 0.03) / kGravity_mps2 / kDeg, 0.1);
    EXPECT_GT(found.vertical.sigma_rad / kDeg, off_deg);
    EXPECT_LT(found.vertical.sigma_rad / kDeg, 1);
}

TEST(Levelling, HoldsTheTiltOfADriveThatDrifts) {
    Drive drive;
    drive.seconds = 80;
    drive.drift = {0.002 * kDeg, -0.0015 * kDeg, 0};  // 2 deg in 800 scans
    drive.noise_m = 0.005;
    const double before_deg = drive.tiltOff_deg(drive.level(false).graph);
    drive.truth.clear();
    const auto found = drive.level(true);
    EXPECT_TRUE(found.vertical.holdsTilt);
    EXPECT_GT(before_deg, 1);
    EXPECT_LT(drive.tiltOff_deg(found.graph), 0.2);
    EXPECT_TRUE(found.graph.poses().front().isApprox(drive.truth.front(), 0.01));
}

TEST(Levelling, TakesAccelerationsInG) {
    Drive drive;
    drive.unit = 9.81;
    EXPECT_LT(drive.off_deg(drive.level(false).vertical.up), 0.02);
}

TEST(Levelling, RefusesWithoutGravityAndWithoutSamples) {
    Drive floating;
    floating.gravity_mps2 = 0;
    EXPECT_NE(floating.level(true).vertical.refusal.find("do not show gravity"), std::string::npos);
    Drive silent;
    silent.isMissing = [](double time_s) { return std::fmod(time_s + 10, 3) < 0.2; };
    const auto found = silent.level(true);
    EXPECT_NE(found.vertical.refusal.find("no four seconds"), std::string::npos);
    EXPECT_FALSE(found.vertical.holdsTilt);
}
}  // namespace delio
