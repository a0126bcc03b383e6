#pragma once
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "delio/odometry/odometry.h"
#include "delio/slam/options.h"
#include "poses.h"
#include "ring_scan.h"

/** What the tests of both odometries share. */
namespace delio::odometry_test {
using Poses = std::vector<Eigen::Isometry3d>;
using test::poseAtDeg;

constexpr double kMetres = 0.02, kDegrees = 0.2;

/** A drive through the yard: half a metre a scan, bending, with a little pitch and roll. */
inline Poses drive(std::size_t count) {
    Poses poses{poseAtDeg(-3, 1, 0, 15)};
    while (poses.size() < count) {
        const auto k = static_cast<double>(poses.size());
        poses.push_back(poses.back() * poseAtDeg(0.45 + 0.02 * k, 0.01, 0, -1.5, 0.2 * std::cos(k),
                                                 0.2 * std::sin(k)));
    }
    return poses;
}

/** From pose i - 1 to pose i. */
inline Eigen::Isometry3d stepTo(const Poses& poses, std::size_t i) {
    return poses[i - 1].inverse() * poses[i];
}

inline Scan scanAt(const Eigen::Isometry3d& pose, std::uint32_t seed,
                   const test::Scene& scene = test::yard()) {
    test::Noise noise(seed);
    return test::scanOf(test::ringScan(scene, pose, {28, 400, -24, 8, 0.01}, noise).points);
}

inline std::vector<Scan> scansOf(const Poses& poses, const test::Scene& scene = test::yard()) {
    std::vector<Scan> scans;
    for (const auto& pose : poses)
        scans.push_back(scanAt(pose, static_cast<std::uint32_t>(scans.size()), scene));
    return scans;
}

/** The paper's first pair is searched in a smaller disc, or not at all, which takes its time
 *  else. */
inline Options quick(const std::string& profile, double search_radius = 0) {
    auto options = Options::ofProfile(profile);
    options.paper.lineRegistration.search_radius = search_radius;
    return options;
}

inline std::vector<Step> stepsOf(const std::vector<Scan>& scans, const OdometryOptions& options) {
    const auto odometry = makeOdometry(options);
    std::vector<Step> steps;
    steps.reserve(scans.size());
    for (const auto& scan : scans) steps.push_back(odometry->process(scan));
    return steps;
}

/** Of a time or a detail; NaN where there is none of this name. */
inline double valueOf(const std::vector<Named>& values, const std::string& name) {
    for (const auto& [known, value] : values)
        if (name == known) return value;
    return std::numeric_limits<double>::quiet_NaN();
}

inline void expectCovariance(const Increment& increment) {
    const Matrix6& C = increment.covariance;
    EXPECT_TRUE(C.allFinite());
    EXPECT_LE((C - C.transpose()).norm(), 1e-12 * C.norm());
    EXPECT_EQ(C.llt().info(), Eigen::Success) << C;
}

inline void expectPose(const Eigen::Isometry3d& found, const Eigen::Isometry3d& truth,
                       double metres, double degrees) {
    EXPECT_LT(test::metresBetween(found, truth), metres) << found.matrix() << "\nfor\n"
                                                         << truth.matrix();
    EXPECT_LT(test::degreesBetween(found, truth), degrees) << found.matrix() << "\nfor\n"
                                                           << truth.matrix();
}

inline void expectNoMotion(const Eigen::Isometry3d& pose) {
    EXPECT_EQ(pose.matrix(), Eigen::Isometry3d::Identity().matrix());
}
}  // namespace delio::odometry_test
