#include "core/principal_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

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

TEST(CharacteristicPolynomial, CountsTheEigenvaluesAboveAny) {
    std::srand(2);
    int counts[4] = {};
    for (int i = 0; i < 3000; ++i) {
        const Eigen::Vector3d values = Eigen::Vector3d::Random();
        const Eigen::Matrix3d R = Eigen::Quaterniond::UnitRandom().matrix(),
                              turned = R * values.asDiagonal() * R.transpose();
        const CharacteristicPolynomial polynomial((turned + turned.transpose()) / 2);
        EXPECT_NEAR(polynomial.trace(), values.sum(), 1e-14);
        EXPECT_NEAR(polynomial.determinant(), values.prod(), 1e-14);
        EXPECT_NEAR(polynomial.minors(),
                    values[0] * values[1] + values[1] * values[2] + values[2] * values[0], 1e-14);
        const double limit = Eigen::Matrix<double, 1, 1>::Random()[0];
        if ((values.array() - limit).abs().minCoeff() < 1e-9) continue;
        const auto above = static_cast<int>((values.array() > limit).count());
        EXPECT_EQ(polynomial.above(limit), above) << values.transpose() << " and " << limit;
        ++counts[above];
    }
    for (const int count : counts) EXPECT_GT(count, 100);
}

TEST(CharacteristicPolynomial, OfNothing) {
    const CharacteristicPolynomial zero(Eigen::Matrix3d::Zero());
    EXPECT_EQ(zero.above(0), 0);
    EXPECT_EQ(zero.above(1), 0);
    EXPECT_EQ(zero.above(-1), 3);
}
}  // namespace delio
