#include "delio/evaluation/absolute_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "poses.h"

namespace {
using delio::evaluation::absoluteError;
using delio::test::poseAt;
using Poses = std::vector<Eigen::Isometry3d>;

/** A winding drive in three dimensions. */
Poses winding() {
    Poses poses;
    for (int i = 0; i < 200; ++i)
        poses.push_back(poseAt(i, 30 * std::sin(0.05 * i), 2 * std::cos(0.02 * i), 0.1 * i, 0, 0));
    return poses;
}

/** Every second pose moved up, the others down: no rigid motion takes that back. */
Poses shaken(const Poses& poses, double by_m) {
    Poses result = poses;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i].translation().z() += i % 2 ? by_m : -by_m;
    return result;
}

TEST(AbsoluteError, NoRigidMotionChangesIt) {
    const auto drive = winding();
    EXPECT_NEAR(absoluteError(drive, drive).rmse_m, 0, 1e-9);
    const auto estimate = shaken(drive, 0.25);
    const auto plain = absoluteError(drive, estimate);
    EXPECT_NEAR(plain.rmse_m, 0.25, 1e-3);
    EXPECT_NEAR(plain.max_m, 0.25, 5e-3);
    for (const double yaw : {0.5, 3.1}) {
        const auto world = poseAt(4e5, -5e6, 100, yaw, -1, 2);
        auto moved = estimate;
        for (auto& pose : moved) pose = world * pose;
        EXPECT_NEAR(absoluteError(drive, moved).rmse_m, plain.rmse_m, 1e-6);
        EXPECT_NEAR(absoluteError(drive, moved).max_m, plain.max_m, 1e-6);
    }
}

TEST(AbsoluteError, ScaleIsAnError) {
    // 0, 1, ... 100 m against the same 1 % longer: the residuals after centring are 1 % of -50..50.
    Poses drive, longer;
    double squares = 0;
    for (int i = 0; i <= 100; ++i) {
        drive.push_back(poseAt(i, 0, 0));
        longer.push_back(poseAt(1.01 * i, 0, 0));
        squares += std::pow(0.01 * (i - 50), 2);
    }
    EXPECT_NEAR(absoluteError(drive, longer).rmse_m, std::sqrt(squares / 101), 1e-9);
    EXPECT_NEAR(absoluteError(drive, longer).max_m, 0.5, 1e-9);
}

TEST(AbsoluteError, AMirroredDriveIsNotAligned) {
    const auto drive = winding();
    auto mirrored = drive;
    for (auto& pose : mirrored) pose.translation().y() *= -1;
    EXPECT_GT(absoluteError(drive, mirrored).rmse_m, 0.5);
}

TEST(AbsoluteError, FewPosesAreNoTrap) {
    EXPECT_TRUE(std::isnan(absoluteError({}, {}).rmse_m));
    EXPECT_NEAR(absoluteError({poseAt(1, 2, 3)}, {poseAt(9, 9, 9)}).rmse_m, 0, 1e-12);
    EXPECT_NEAR(
        absoluteError({poseAt(0, 0, 0), poseAt(0, 0, 2)}, {poseAt(0, 0, 0), poseAt(3, 0, 0)})
            .rmse_m,
        0.5, 1e-12);
}
}  // namespace
