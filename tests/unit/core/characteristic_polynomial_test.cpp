#include "core/principal_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace delio {
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
