#include "delio/pose_pdf.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "ring_scan.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** The numbers of T * (exp(w), t), e = [t w], in MRPT's order. */
Vector6 numbersOf(const CPose3D& pose, const Vector6& e) {
    const Eigen::Vector3d w = e.tail<3>();
    const Eigen::Matrix3d turn = w.norm() > 0 ? Eigen::AngleAxisd(w.norm(), w.normalized()).matrix()
                                              : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    const CPose3D moved = pose + CPose3D(turn, Eigen::Vector3d(e.head<3>()));
    Vector6 numbers;
    numbers << moved.x(), moved.y(), moved.z(), moved.yaw(), moved.pitch(), moved.roll();
    return numbers;
}

TEST(PosePdf, IsTheCovarianceOfThePosesNumbersWithUnequalRollAndYaw) {
    Increment increment;
    increment.pose = CPose3D(3, -2, 1, 0.7, 0.3, -0.5);
    // Roll a hundred times as uncertain as yaw, all of it correlated.
    test::Noise noise;
    Matrix6 root;
    for (int i = 0; i < 36; ++i) root(i) = 0.3 * noise.uniform();
    root.diagonal() << 1, 2, 3, 10, 4, 1;
    root *= 1e-3;
    increment.covariance.asEigen() = root * root.transpose();

    Matrix6 J;
    constexpr double h = 1e-5;
    for (int k = 0; k < 6; ++k)
        J.col(k) = (numbersOf(increment.pose, h * Vector6::Unit(k)) -
                    numbersOf(increment.pose, -h * Vector6::Unit(k))) /
                   (2 * h);
    const Matrix6 expected = J * root * root.transpose() * J.transpose();
    const auto pdf = posePdfOf(increment);
    const Matrix6 found = pdf.cov.asEigen();
    EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << found << "\n\n" << expected;
    EXPECT_GT(found(5, 5), 5 * found(3, 3));
    EXPECT_EQ(pdf.mean, increment.pose);
}
}  // namespace
