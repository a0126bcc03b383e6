#include "delio/evaluation/frame_check.h"

#include <gtest/gtest.h>
#include <mrpt/random/RandomGenerators.h>

#include <Eigen/Dense>
#include <cmath>

#include "delio/core/geometry.h"
#include "delio/formats/trajectory.h"
#include "poses.h"

namespace {
using delio::evaluation::findFrameMismatch;
using delio::evaluation::FrameMismatch;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

/** A LiDAR's winding drive, x forward. */
Poses lidarDrive(std::size_t count = 120, double step_m = 0.8) {
    Poses poses = {Eigen::Isometry3d::Identity()};
    for (std::size_t i = 1; i < count; ++i) {
        const double yaw = 0.05 * std::sin(0.1 * static_cast<double>(i));
        poses.push_back(poses.back() * poseAt(step_m, 0.01, -0.005, yaw, 0.002, 0));
    }
    return poses;
}

/** A LiDAR's pose in cam0 close to KITTI's, a degree or two off the nominal axes. */
Eigen::Isometry3d lidarToCamera() {
    Eigen::Matrix3d nominal;
    nominal << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    const Eigen::Matrix3d R =
        nominal * Eigen::AngleAxisd(0.03, Eigen::Vector3d(1, 1, -1).normalized());
    return delio::isometry(R, {-0.004, -0.076, -0.27});
}

Poses asCamera(const Poses& lidar) {
    return delio::io::lidarToCam0({lidar, {}}, lidarToCamera()).poses;
}

TEST(FrameCheck, NamesTheFrameThatIsWrong) {
    const auto lidar = lidarDrive(), camera = asCamera(lidar);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(camera, camera), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::lidarAgainstCamera);
    EXPECT_EQ(findFrameMismatch(lidar, camera), FrameMismatch::cameraAgainstLidar);
    EXPECT_EQ(findFrameMismatch(camera, asCamera(camera)), FrameMismatch::cameraAgainstLidar);
}

TEST(FrameCheck, DrivesInReverseAreSeenToo) {
    const auto lidar = lidarDrive(120, -0.8);
    EXPECT_EQ(findFrameMismatch(asCamera(lidar), lidar), FrameMismatch::lidarAgainstCamera);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
}

TEST(FrameCheck, TheFixedFrameDoesNotMatter) {
    const auto lidar = lidarDrive();
    auto moved = lidar;
    const auto world = poseAt(5e5, 4e6, 100, 2, 0, 0);
    for (auto& pose : moved) pose = world * pose;
    EXPECT_EQ(findFrameMismatch(lidar, moved), FrameMismatch::none);
    EXPECT_EQ(findFrameMismatch(asCamera(lidar), moved), FrameMismatch::lidarAgainstCamera);
}

// KITTI's first scans, or a robot that went across a table.
TEST(FrameCheck, ShortPathsTellAsWell) {
    for (const auto& lidar : {lidarDrive(5, 0.8), lidarDrive(20, 0.05)}) {
        const auto camera = asCamera(lidar);
        EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
        EXPECT_EQ(findFrameMismatch(camera, camera), FrameMismatch::none);
        EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::lidarAgainstCamera);
        EXPECT_EQ(findFrameMismatch(lidar, camera), FrameMismatch::cameraAgainstLidar);
    }
}

TEST(FrameCheck, TooLittleMotionTellsNothing) {
    const auto lidar = lidarDrive(3), camera = asCamera(lidar);
    EXPECT_EQ(findFrameMismatch(camera, lidar), FrameMismatch::unknown);
    EXPECT_EQ(findFrameMismatch(lidar, lidar), FrameMismatch::none);
    const Poses still(500, Eigen::Isometry3d::Identity());
    EXPECT_EQ(findFrameMismatch(still, still), FrameMismatch::unknown);
    EXPECT_EQ(findFrameMismatch({}, {}), FrameMismatch::unknown);
}

TEST(FrameCheck, ABadEstimateIsNotAMismatch) {
    const auto camera = asCamera(lidarDrive());
    EXPECT_EQ(findFrameMismatch(camera, Poses(camera.size(), Eigen::Isometry3d::Identity())),
              FrameMismatch::none);
    mrpt::random::CRandomGenerator random(1);
    Poses lost;
    for (std::size_t i = 0; i < camera.size(); ++i)
        lost.push_back(poseAt(random.drawGaussian1D(0, 5), random.drawGaussian1D(0, 5),
                              random.drawGaussian1D(0, 5)));
    EXPECT_EQ(findFrameMismatch(camera, lost), FrameMismatch::none);
}
}  // namespace
