#include "delio/evaluation/rotation_angle.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "delio/core/geometry.h"

namespace {
using delio::evaluation::rotationAngle_rad;

/** A turn by `angle_rad` about a slanting axis, with `noise` on every entry of the matrix. */
Eigen::Isometry3d turn(double angle_rad, double noise = 0) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
    Eigen::Matrix3d R = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) += i % 2 ? noise : -noise;
    return delio::isometry(R, Eigen::Vector3d::Zero());
}

TEST(RotationAngle, IsExactFromZeroToHalfATurn) {
    EXPECT_EQ(rotationAngle_rad(Eigen::Isometry3d::Identity()), 0);
    for (const double angle : {1e-12, 1e-8, 1e-3, 1.0, M_PI / 2, 3.0, M_PI - 1e-8, M_PI})
        EXPECT_NEAR(rotationAngle_rad(turn(angle)), angle, 1e-14) << angle;
}

TEST(RotationAngle, NoiseOfTheMatrixMovesItNoMoreThanTheNoise) {
    constexpr double noise = 1e-7;  // what a file with seven digits has; acos would give 3e-4
    for (const double angle : {0.0, 1e-6, 1.0, M_PI - 1e-6, M_PI})
        EXPECT_NEAR(rotationAngle_rad(turn(angle, noise)), angle, 3 * noise) << angle;
}
}  // namespace
