#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/principal_axes.h"

namespace delio {
namespace {
void expectAxesOf(const Eigen::Matrix3d& scatter) {
    const auto [variances, axes] = principalAxes(scatter);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> iterative(scatter);
    const double size = scatter.norm();
    EXPECT_LE((variances - iterative.eigenvalues()).norm(), 1e-14 * size) << scatter;
    EXPECT_LE((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-14) << scatter;
    EXPECT_LE((axes * variances.asDiagonal() * axes.transpose() - scatter).norm(), 1e-14 * size)
        << scatter;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& matrix) {
    return (matrix + matrix.transpose()) / 2;
}
}  // namespace

TEST(PrincipalAxes, OfAnyScatter) {
    std::srand(1);
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Matrix3d A = Eigen::Matrix3d::Random();
        expectAxesOf(A * A.transpose());
        const Eigen::Vector3d flat(1e-6, 1, 1 + 1e-3 * i);
        const Eigen::Matrix3d R = Eigen::Quaterniond::UnitRandom().matrix();
        expectAxesOf(symmetric(R * flat.asDiagonal() * R.transpose()));
        const Eigen::Vector3d line(1e-8, 1e-8 + 1e-10 * i, 1);
        expectAxesOf(symmetric(R * line.asDiagonal() * R.transpose()));
        // Two that are alike, but for rounding: of whatever size.
        const Eigen::Vector3d round =
            std::pow(10, i % 40 - 20) * Eigen::Vector3d(1, 1, 1 + 1e-15 * i);
        expectAxesOf(symmetric(R * round.asDiagonal() * R.transpose()));
    }
}

TEST(PrincipalAxes, WhereAllAxesAreAlike) {
    expectAxesOf(Eigen::Matrix3d::Identity());
    expectAxesOf(Eigen::Vector3d(0, 0, 2).asDiagonal());
    expectAxesOf(Eigen::Vector3d(3, 3, 1).asDiagonal());
    const auto [variances, axes] = principalAxes(Eigen::Matrix3d::Zero());
    EXPECT_EQ(variances, Eigen::Vector3d::Zero());
    EXPECT_EQ(axes, Eigen::Matrix3d::Identity());
}
}  // namespace delio
