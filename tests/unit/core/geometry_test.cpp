// Every operation at every critical angle, each against another way to the same thing.
#include "delio/core/geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tangents.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using mrpt::poses::CPose3D;
using test::directions;
using test::poseAt;
using test::twistsOf;

using Matrix4l = Eigen::Matrix<long double, 4, 4>;

/** The matrix exponential of a twist by its power series, in long doubles. */
Eigen::Matrix4d seriesOf(const Vector6& twist) {
    const Eigen::Matrix<long double, 6, 1> e = twist.cast<long double>();
    Matrix4l T = Matrix4l::Zero();
    T(0, 1) = -e[5], T(0, 2) = e[4], T(1, 2) = -e[3];
    T(1, 0) = e[5], T(2, 0) = -e[4], T(2, 1) = e[3];
    T.topRightCorner<3, 1>() = e.head<3>();
    Matrix4l term = Matrix4l::Identity(), sum = term;
    for (int k = 1; k < 60; ++k) {
        term = term * T / static_cast<long double>(k);
        sum += term;
    }
    return sum.cast<double>();
}

double metres(const Vector6& twist) { return 1 + twist.head<3>().norm(); }

bool isRotation(const Matrix3d& R) {
    return (R * R.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-15 * 4 &&
           R.determinant() > 0;
}

class Geometry : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(CriticalAngles, Geometry, testing::ValuesIn(test::criticalAngles()));

TEST(Geometry, HatIsTheCrossProduct) {
    test::Noise noise;
    for (const double length : {0.0, 1e-8, 1.0, 1e6})
        for (const auto& direction : directions()) {
            const Vector3d v = length * direction, u = noise.normals();
            EXPECT_EQ(Vector3d(hat(v) * u - v.cross(u)).norm(), 0);
            EXPECT_EQ(hat(v).transpose(), -hat(v));
        }
}

TEST_P(Geometry, RotationExpIsItsPowerSeries) {
    for (const auto& twist : twistsOf(GetParam())) {
        const Matrix3d R = rotationExp(twist.tail<3>());
        EXPECT_LT((R - seriesOf(twist).topLeftCorner<3, 3>()).cwiseAbs().maxCoeff(), 1e-15);
        EXPECT_TRUE(isRotation(R));
    }
}

TEST_P(Geometry, RotationsThereAndBack) {
    for (const auto& direction : directions()) {
        const Vector3d w = GetParam() * direction;
        EXPECT_LT((rotationLog(rotationExp(w)) - w).norm(), 2e-15) << w.transpose();
        EXPECT_LT((rotationLog(rotationExp(w).transpose()) + w).norm(), 2e-15) << w.transpose();
    }
}

TEST_P(Geometry, AngleOfIsTheLengthOfTheLogarithm) {
    for (const auto& direction : directions()) {
        const Matrix3d R = rotationExp(GetParam() * direction);
        EXPECT_NEAR(angleOf(R), GetParam(), 1e-15);
        EXPECT_NEAR(angleOf(R), rotationLog(R).norm(), 1e-15);
        EXPECT_NEAR(angleOf(R.transpose()), GetParam(), 1e-15);
    }
}

TEST(Geometry, HalfATurnAndMoreComeBackAsARotationOfAtMostPi) {
    for (const auto& direction : directions())
        for (const double angle : {M_PI, M_PI + 1e-9, 4.0, 2 * M_PI - 1e-8}) {
            const Matrix3d R = rotationExp(angle * direction);
            const Vector3d w = rotationLog(R);
            EXPECT_LE(w.norm(), M_PI * (1 + 1e-15));
            EXPECT_NEAR(w.norm(), 2 * M_PI - angle, 2e-15);
            EXPECT_LT((rotationExp(w) - R).norm(), 2e-15);
        }
}

/** The logarithm next to `w`: it jumps at half a turn, its derivative does not. */
Vector3d logNear(const Vector3d& w, const Matrix3d& R) {
    const Vector3d log = rotationLog(R);
    if ((log - w).norm() < M_PI || log.norm() == 0) return log;
    return log * (1 - 2 * M_PI / log.norm());
}

void expectInverseRightJacobian(const Vector3d& w) {
    const auto numeric = test::jacobianOf<3>(
        [&](const Vector3d& d) { return logNear(w, rotationExp(w) * rotationExp(d)); });
    EXPECT_LT((inverseRightJacobian(w) - numeric).cwiseAbs().maxCoeff(), 2e-9) << w.transpose();
}

TEST_P(Geometry, InverseRightJacobianIsTheDerivativeOfTheLogarithm) {
    for (const auto& direction : directions()) expectInverseRightJacobian(GetParam() * direction);
}

/** SO(3)'s right Jacobian by its power series, in long doubles. */
Matrix3d rightJacobianSeries(const Vector3d& w) {
    using Matrix3l = Eigen::Matrix<long double, 3, 3>;
    const Matrix3l W = hat(w).cast<long double>();
    Matrix3l term = Matrix3l::Identity(), sum = term;
    for (int k = 2; k < 60; ++k) {
        term = -term * W / static_cast<long double>(k);
        sum += term;
    }
    return sum.cast<double>();
}

TEST_P(Geometry, InverseRightJacobianIsTheInverseOfThePowerSeries) {
    for (const auto& direction : directions()) {
        const Vector3d w = GetParam() * direction;
        const Matrix3d product = inverseRightJacobian(w) * rightJacobianSeries(w);
        EXPECT_LT((product - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 2e-15) << w.transpose();
    }
}

TEST(Geometry, InverseRightJacobianHoldsBeyondHalfATurn) {
    for (const auto& direction : directions())
        for (const double angle : {M_PI, 3.5, 5.0}) expectInverseRightJacobian(angle * direction);
}

TEST_P(Geometry, PoseExpIsItsPowerSeries) {
    for (const auto& twist : twistsOf(GetParam()))
        EXPECT_LT((poseExp(twist).matrix() - seriesOf(twist)).cwiseAbs().maxCoeff(),
                  1e-12 * metres(twist))
            << twist.transpose();
}

TEST_P(Geometry, PoseExpIsWhereAConstantTwistLeadsTo) {
    constexpr int kSteps = 20000;
    for (const double length : {0.0, 1.0, 30.0}) {
        Vector6 twist;
        twist << length * Vector3d(0.6, -0.64, 0.48), GetParam() * Vector3d(0.36, 0.48, 0.8);
        const Vector6 each = twist / kSteps;
        const Isometry3d step = isometry(rotationExp(each.tail<3>()), each.head<3>());
        Isometry3d pose = Isometry3d::Identity();
        for (int i = 0; i < kSteps; ++i) pose = pose * step;
        // Euler's error: a step's arc instead of its chord, half a step of turn on the way.
        EXPECT_LT((poseExp(twist).matrix() - pose.matrix()).norm(),
                  1e-10 + length * GetParam() / kSteps);
    }
}

TEST_P(Geometry, PosesThereAndBack) {
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d pose = poseExp(twist);
        EXPECT_LT((poseLog(pose) - twist).norm(), 1e-12 * metres(twist)) << twist.transpose();
        EXPECT_LT((poseLog(pose.inverse()) + twist).norm(), 1e-12 * metres(twist));
        EXPECT_LT((poseExp(poseLog(pose)).matrix() - pose.matrix()).norm(), 1e-12 * metres(twist));
    }
}

TEST_P(Geometry, PartsOfATwistAddUpToAllOfIt) {
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d parts = poseExp(0.3 * twist) * poseExp(0.7 * twist);
        EXPECT_LT((parts.matrix() - poseExp(twist).matrix()).norm(), 1e-12 * metres(twist));
    }
}

TEST_P(Geometry, AdjointMovesATangentToTheOtherSide) {
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d pose = poseExp(twist);
        const auto numeric = test::jacobianOf<6>(
            [&](const Vector6& e) { return poseLog(pose * poseExp(e) * pose.inverse()); });
        EXPECT_LT((adjointOf(pose) - numeric).cwiseAbs().maxCoeff(), 1e-8 * metres(twist));
        for (const Vector6& e : {Vector6(0.1 * Vector6::Ones()), twist}) {
            const Eigen::Matrix4d left = (pose * poseExp(e)).matrix(),
                                  right = (poseExp(adjointOf(pose) * e) * pose).matrix();
            EXPECT_LT((left - right).norm(), 1e-9 * metres(twist)) << twist.transpose();
        }
    }
}

TEST_P(Geometry, AdjointsMultiplyAsPosesDo) {
    const Isometry3d other = poseAt(3, -2, 1, 0.5, -0.2, 0.7);
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d pose = poseExp(twist);
        EXPECT_LT((adjointOf(pose * other) - adjointOf(pose) * adjointOf(other)).norm(),
                  1e-13 * metres(twist));
        EXPECT_LT((adjointOf(pose.inverse()) * adjointOf(pose) - Matrix6::Identity()).norm(),
                  1e-13 * metres(twist));
    }
}

TEST_P(Geometry, IsometryIsMadeOfItsParts) {
    for (const auto& twist : twistsOf(GetParam())) {
        const Matrix3d R = rotationExp(twist.tail<3>());
        const Isometry3d pose = isometry(R, twist.head<3>());
        EXPECT_EQ(pose.linear(), R);
        EXPECT_EQ(pose.translation(), twist.head<3>());
        EXPECT_EQ(pose.matrix().row(3), Eigen::RowVector4d(0, 0, 0, 1));
        EXPECT_LT((pose * Vector3d(1, 2, 3) - (R * Vector3d(1, 2, 3) + twist.head<3>())).norm(),
                  1e-13 * metres(twist));
    }
}

TEST_P(Geometry, NormalisedLeavesARotationAndMendsWhatIsNearlyOne) {
    test::Noise noise;
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d pose = poseExp(twist);
        const Matrix3d R = pose.linear();
        EXPECT_LT((normalised(R) - R).cwiseAbs().maxCoeff(), 2e-15);
        EXPECT_TRUE(isRotation(normalised(R)));
        Matrix3d worn = R;
        for (int i = 0; i < 9; ++i) worn(i) += 1e-6 * noise.uniform();
        ASSERT_FALSE(isRotation(worn));
        EXPECT_TRUE(isRotation(normalised(worn)));
        EXPECT_LT((normalised(worn) - R).cwiseAbs().maxCoeff(), 4e-6);
        const Isometry3d mended = normalised(isometry(worn, pose.translation()));
        EXPECT_EQ(mended.linear(), normalised(worn));
        EXPECT_EQ(mended.translation(), pose.translation());
    }
}

TEST(Geometry, ProductsOfManyRotationsStayOnesWhenNormalised) {
    const Matrix3d step = rotationExp({0.01, -0.02, 0.3});
    Matrix3d R = Matrix3d::Identity();
    for (int i = 0; i < 100000; ++i) R = normalised(Matrix3d(R * step));
    EXPECT_TRUE(isRotation(R));
}

TEST_P(Geometry, MrptHasTheSamePoses) {
    const Isometry3d other = poseAt(3, -2, 1, 0.5, -0.2, 0.7);
    for (const auto& twist : twistsOf(GetParam())) {
        const Isometry3d pose = poseExp(twist);
        EXPECT_EQ(fromMrpt(toMrpt(pose)).matrix(), pose.matrix());  // there and back
        const CPose3D a = toMrpt(pose), b = toMrpt(other);
        const double tolerance = 1e-14 * metres(twist);
        EXPECT_LT((fromMrpt(a + b).matrix() - (pose * other).matrix()).norm(), tolerance);
        EXPECT_LT((fromMrpt(a - b).matrix() - (other.inverse() * pose).matrix()).norm(), tolerance);
        EXPECT_LT((fromMrpt(-a).matrix() - pose.inverse().matrix()).norm(), tolerance);
        Vector3d moved;
        a.composePoint(1, 2, 3, moved.x(), moved.y(), moved.z());
        EXPECT_LT((moved - pose * Vector3d(1, 2, 3)).norm(), tolerance);
    }
}

TEST(Geometry, MrptsAnglesAreYawPitchRoll) {
    const CPose3D mrpts(1, 2, 3, 0.4, -0.5, 0.6);
    const Isometry3d pose = poseAt(1, 2, 3, 0.4, -0.5, 0.6);
    EXPECT_LT((fromMrpt(mrpts).matrix() - pose.matrix()).norm(), 1e-15);
    const CPose3D back = toMrpt(pose);
    EXPECT_NEAR(back.yaw(), 0.4, 1e-15);
    EXPECT_NEAR(back.pitch(), -0.5, 1e-15);
    EXPECT_NEAR(back.roll(), 0.6, 1e-15);
}
}  // namespace
