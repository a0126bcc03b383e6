// The pose of a LiDAR relative to another one, from points on known surfaces.
#include "odometry/calibrate_extrinsics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using namespace delio::odometry;
using test::degreesBetween;
using test::poseAt;
using test::rotationAbout;

/** Points on a plane, 12 m by 12 m about `centre`. */
Eigen::Matrix3Xd onPlane(const Eigen::Vector3d& centre, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b, int points, test::Noise& noise) {
    constexpr double kHalf_m = 6;
    Eigen::Matrix3Xd all(3, points);
    for (int i = 0; i < points; ++i)
        all.col(i) = centre + kHalf_m * (noise.uniform() * a + noise.uniform() * b);
    return all;
}

/** A vehicle that drives along x and turns among a ground and, unless `groundOnly`, three walls;
 *  the other sensor measures for 0.1 s about each moment. */
class Extrinsics : public testing::Test {
 protected:
    Eigen::Matrix3Xd world(int points) {
        const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                              z = Eigen::Vector3d::UnitZ();
        Eigen::Matrix3Xd all = onPlane({0.1, 0.1, -1.9}, x, y, points, noise_);
        if (groundOnly_) return all;
        for (const auto& wall : {onPlane({0.1, 6.1, 3.9}, x, z, points, noise_),
                                 onPlane({6.1, 0.1, 3.9}, y, z, points, noise_),
                                 onPlane({-6.1, 0.1, 3.9}, y, z, points, noise_)}) {
            all.conservativeResize(3, all.cols() + wall.cols());
            all.rightCols(wall.cols()) = wall;
        }
        return all;
    }
    std::vector<CalibrationView> views(double noise_m) {
        const Twist motion{{3, 0.2, 0}, {0, 0, 0.5}};
        std::vector<CalibrationView> views;
        for (int k = 0; k < 12; ++k) {
            const Eigen::Isometry3d vehicle = motion.after(0.1 * k);
            PlaneMap map{PlaneMapOptions{}};
            map.add(vehicle.inverse() * world(20000));
            views.push_back({std::move(map), PoseTable(motion, -0.1, 0.1)});
            const auto seen = world(1500);
            auto& view = views.back();
            view.points.resize(3, seen.cols());
            for (Eigen::Index i = 0; i < seen.cols(); ++i) {
                const double time_s = 0.05 * noise_.uniform();
                const Eigen::Isometry3d sensor = motion.after(0.1 * k + time_s) * truth_;
                const Eigen::Vector3d error = noise_m * noise_.normals();
                view.points.col(i) = (sensor.inverse() * seen.col(i) + error).cast<float>();
                view.times_s.push_back(static_cast<float>(time_s));
            }
        }
        return views;
    }
    const Eigen::Isometry3d truth_ = poseAt(0.8, -0.4, 0.3, 0.5);
    const Eigen::Isometry3d given_ =
        isometry(truth_.linear() * rotationAbout({1, -1, 1}, 1.7),
                 truth_.translation() + Eigen::Vector3d(0.05, -0.05, 0.05));
    test::Noise noise_;
    bool groundOnly_ = false;
};

TEST_F(Extrinsics, AreThePlantedOnes) {
    const auto found = calibrateExtrinsics(views(0), given_, PlaneRegistrationOptions{});
    ASSERT_TRUE(found.estimate.valid);
    EXPECT_EQ(found.estimate.translation.unobservedAxes.cols(), 0);
    EXPECT_EQ(found.estimate.rotation.unobservedAxes.cols(), 0);
    EXPECT_LT((found.estimate.pose().translation() - truth_.translation()).norm(), 2e-4);
    EXPECT_LT(degreesBetween(found.estimate.rotation.rotation, truth_.linear()), 2e-3);
}

// Neither an optimistic nor a pessimistic precision: errors of 30 drives in units of it.
TEST_F(Extrinsics, HaveTheErrorThatTheirCovarianceSays) {
    constexpr int kDrives = 30;
    Vector6 squares = Vector6::Zero();
    for (int drive = 0; drive < kDrives; ++drive) {
        const auto found = calibrateExtrinsics(views(0.02), truth_, PlaneRegistrationOptions{});
        ASSERT_TRUE(found.estimate.valid);
        const Eigen::Isometry3d pose = found.estimate.pose();
        Vector6 error;
        error << pose.translation() - truth_.translation(),
            rotationLog(pose.linear() * truth_.linear().transpose());
        squares += error.cwiseAbs2().cwiseQuotient(found.covariance.diagonal());
    }
    const Vector6 ratios = (squares / kDrives).cwiseSqrt();
    EXPECT_GT(ratios.minCoeff(), 0.5) << ratios.transpose();
    EXPECT_LT(ratios.maxCoeff(), 1.6) << ratios.transpose();
}

TEST_F(Extrinsics, KeepWhatTheGroundAloneDoesNotShow) {
    groundOnly_ = true;
    const auto found = calibrateExtrinsics(views(0.01), given_, PlaneRegistrationOptions{});
    ASSERT_TRUE(found.estimate.valid);
    ASSERT_EQ(found.estimate.translation.unobservedAxes.cols(), 2);
    EXPECT_LT(found.estimate.translation.unobservedAxes.row(2).cwiseAbs().maxCoeff(), 0.05);
    ASSERT_EQ(found.estimate.rotation.unobservedAxes.cols(), 1);
    const Eigen::Isometry3d pose = found.estimate.pose();
    const Eigen::Vector3d moved = pose.translation() - given_.translation();
    EXPECT_LT(moved.head<2>().norm(), 0.01);
    EXPECT_NEAR(pose.translation().z(), truth_.translation().z(), 3e-3);
    const Eigen::Vector3d tilt = pose.linear().row(2) - truth_.linear().row(2);
    EXPECT_LT(tilt.norm(), 1e-3);
}

TEST_F(Extrinsics, AreNotMadeUpWhereNothingMeets) {
    auto all = views(0.01);
    for (auto& view : all) view.points.row(2).array() += 50;
    EXPECT_FALSE(calibrateExtrinsics(all, given_, PlaneRegistrationOptions{}).estimate.valid);
}
}  // namespace
