#include "delio/core/increment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>

#include "tangents.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using test::poseAt;

/** pose * (exp(w), t), as Increment has it of its error. */
Isometry3d withError(const Isometry3d& pose, const Vector6& e) {
    return pose * isometry(rotationExp(e.tail<3>()), e.head<3>());
}

/** The e of withError(pose, e) = truth. */
Vector6 errorOf(const Isometry3d& pose, const Isometry3d& truth) {
    const Isometry3d off = pose.inverse() * truth;
    Vector6 e;
    e << off.translation(), rotationLog(off.linear());
    return e;
}

/** Any covariance, with standard deviations of about `sigma`. */
Matrix6 anyCovariance(double sigma, test::Noise& noise) {
    Matrix6 root;
    for (int i = 0; i < 36; ++i) root(i) = noise.normal();
    return sigma * sigma * (root * root.transpose() / 6 + 0.1 * Matrix6::Identity());
}

std::vector<Isometry3d> somePoses() {
    std::vector<Isometry3d> poses;
    for (const double angle : {0.0, 1e-8, 1e-3, 0.7, M_PI - 1e-6})
        for (const auto& twist : test::twistsOf(angle)) poses.push_back(poseExp(twist));
    return poses;
}

double metres(const Isometry3d& pose) { return 1 + pose.translation().norm(); }

const Isometry3d kOther = poseAt(1.5, -0.4, 0.2, 0.3, -0.1, 0.05);

TEST(Increment, IsIdentityWhereNothingIsSaid) {
    EXPECT_EQ(Increment().pose.matrix(), Isometry3d::Identity().matrix());
    EXPECT_EQ(Increment().covariance, Matrix6::Identity());
}

void expectChained(const Increment& first, const Increment& second) {
    const Increment both = chained(first, second);
    EXPECT_LT((both.pose.matrix() - (first.pose * second.pose).matrix()).norm(), 1e-12);
    const auto byFirst = test::jacobianOf<6>([&](const Vector6& e) {
        return errorOf(both.pose, withError(first.pose, e) * second.pose);
    });
    const auto bySecond = test::jacobianOf<6>([&](const Vector6& e) {
        return errorOf(both.pose, first.pose * withError(second.pose, e));
    });
    const Matrix6 expected = byFirst * first.covariance * byFirst.transpose() +
                             bySecond * second.covariance * bySecond.transpose();
    EXPECT_LT((both.covariance - expected).norm(), 1e-7 * expected.norm());
    EXPECT_EQ(both.covariance, both.covariance.transpose());
}

TEST(Increment, ChainedFollowsTheNumericDerivatives) {
    test::Noise noise;
    const Matrix6 a = anyCovariance(0.1, noise), b = anyCovariance(0.03, noise);
    for (const auto& pose : somePoses()) {
        expectChained({pose, a}, {kOther, b});
        expectChained({kOther, a}, {pose, b});
    }
}

TEST(Increment, ChainedIsAssociative) {
    test::Noise noise;
    const Increment a{poseAt(1, 2, 3, 0.4), anyCovariance(0.1, noise)},
        b{kOther, anyCovariance(0.1, noise)},
        c{poseAt(-3, 0.1, 0, -2, 0.3, 1), anyCovariance(0.1, noise)};
    const Increment left = chained(chained(a, b), c), right = chained(a, chained(b, c));
    EXPECT_LT((left.pose.matrix() - right.pose.matrix()).norm(), 1e-14);
    EXPECT_LT((left.covariance - right.covariance).norm(), 1e-13);
}

TEST(Increment, OfVehicleFollowsTheNumericDerivative) {
    test::Noise noise;
    const Matrix6 covariance = anyCovariance(0.1, noise);
    const Isometry3d from = poseAt(0.8, -0.3, 1.7, 0.02, 0.1, -0.05);
    for (const auto& pose : somePoses())
        for (const auto& [increment, to] : {std::pair(pose, kOther), std::pair(kOther, pose)}) {
            const Increment vehicle = ofVehicle({increment, covariance}, from, to);
            EXPECT_LT((vehicle.pose.matrix() - (from * increment * to.inverse()).matrix()).norm(),
                      1e-12 * metres(pose));
            const Isometry3d ofSensor = increment, sensorTo = to;
            const auto derivative = test::jacobianOf<6>([&](const Vector6& e) {
                return errorOf(vehicle.pose, from * withError(ofSensor, e) * sensorTo.inverse());
            });
            const Matrix6 expected = derivative * covariance * derivative.transpose();
            EXPECT_LT((vehicle.covariance - expected).norm(), 1e-7 * expected.norm());
            EXPECT_EQ(vehicle.covariance, vehicle.covariance.transpose());
        }
}

TEST(Increment, OfASensorAtTheVehiclesOriginIsTheVehicles) {
    test::Noise noise;
    const Increment increment{kOther, anyCovariance(0.1, noise)};
    const Increment vehicle = ofVehicle(increment, Isometry3d::Identity(), Isometry3d::Identity());
    EXPECT_EQ(vehicle.pose.matrix(), increment.pose.matrix());
    EXPECT_LT((vehicle.covariance - increment.covariance).norm(), 1e-17);
}

/** Covariance of `draws` errors, in units of `expected`: near the identity if that is right. */
Matrix6 inUnitsOf(const Matrix6& expected, int draws, const std::function<Vector6()>& draw) {
    const Eigen::LLT<Matrix6> root(expected);
    Matrix6 sum = Matrix6::Zero();
    for (int i = 0; i < draws; ++i) {
        const Vector6 e = root.matrixL().solve(draw());
        sum += e * e.transpose();
    }
    return sum / draws;
}

/** Normal with covariance 1. */
Vector6 normals(test::Noise& noise) {
    Vector6 e;
    e << noise.normals(), noise.normals();
    return e;
}

constexpr int kDraws = 20000;
constexpr double kSixSigma = 0.06;  // of a variance over so many draws

TEST(Increment, ChainedHoldsInAMonteCarlo) {
    test::Noise noise;
    const Increment first{poseAt(2, -0.5, 0.1, 1.2, 0.2, -0.4), anyCovariance(0.01, noise)},
        second{kOther, anyCovariance(0.004, noise)};
    const Increment both = chained(first, second);
    const Matrix6 a = first.covariance.llt().matrixL(), b = second.covariance.llt().matrixL();
    const Matrix6 found = inUnitsOf(both.covariance, kDraws, [&] {
        const Isometry3d one = withError(first.pose, a * normals(noise)),
                         other = withError(second.pose, b * normals(noise));
        return errorOf(both.pose, one * other);
    });
    EXPECT_LT((found - Matrix6::Identity()).cwiseAbs().maxCoeff(), kSixSigma);
}

TEST(Increment, OfVehicleHoldsInAMonteCarlo) {
    test::Noise noise;
    const Increment ofSensor{poseAt(2, -0.5, 0.1, 0.3, 0.02, -0.04), anyCovariance(0.01, noise)};
    const Isometry3d from = poseAt(0.8, -0.3, 1.7, 0.5, 0.1, -0.05),
                     to = poseAt(0.9, -0.3, 1.6, 1.4, 0.1, -0.05);
    const Increment vehicle = ofVehicle(ofSensor, from, to);
    const Matrix6 root = ofSensor.covariance.llt().matrixL();
    const Matrix6 found = inUnitsOf(vehicle.covariance, kDraws, [&] {
        const Isometry3d truth = withError(ofSensor.pose, root * normals(noise));
        return errorOf(vehicle.pose, from * truth * to.inverse());
    });
    EXPECT_LT((found - Matrix6::Identity()).cwiseAbs().maxCoeff(), kSixSigma);
}
}  // namespace
