#include "delio/graph/pose_graph.h"

#include <gtest/gtest.h>

#include "delio/core/geometry.h"
#include "gauss_newton.h"
#include "ring_scan.h"

namespace {
using namespace delio;

/** The numbers of T * (exp(w), t), e = [t w], in MRPT's order. */
Vector6 numbersOf(const Eigen::Isometry3d& pose, const Vector6& e) {
    const auto moved = toMrpt(test::moved(pose, e));
    Vector6 numbers;
    numbers << moved.x(), moved.y(), moved.z(), moved.yaw(), moved.pitch(), moved.roll();
    return numbers;
}

TEST(PosePdf, IsTheCovarianceOfThePosesNumbersWithUnequalRollAndYaw) {
    Increment increment;
    increment.pose = test::poseAt(3, -2, 1, 0.7, 0.3, -0.5);
    // Roll a hundred times as uncertain as yaw, all of it correlated.
    test::Noise noise;
    Matrix6 root;
    for (int i = 0; i < 36; ++i) root(i) = 0.3 * noise.uniform();
    root.diagonal() << 1, 2, 3, 10, 4, 1;
    root *= 1e-3;
    increment.covariance = root * root.transpose();

    Matrix6 J;
    constexpr double h = 1e-5;
    for (int k = 0; k < 6; ++k)
        J.col(k) = (numbersOf(increment.pose, h * Vector6::Unit(k)) -
                    numbersOf(increment.pose, -h * Vector6::Unit(k))) /
                   (2 * h);
    const Matrix6 expected = J * root * root.transpose() * J.transpose();
    const auto pdf = graph::posePdfOf(increment);
    const Matrix6 found = pdf.cov.asEigen();
    EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << found << "\n\n" << expected;
    EXPECT_GT(found(5, 5), 5 * found(3, 3));
    EXPECT_EQ(fromMrpt(pdf.mean).matrix(), increment.pose.matrix());
}
}  // namespace
