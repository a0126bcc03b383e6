#include "graph/residual.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gauss_newton.h"
#include "pose_graph_drive.h"
#include "poses.h"

namespace {
using namespace delio;
using namespace delio::pose_graph_test;

TEST(Residual, JacobiansAreThoseOfTheResidual) {
    PoseNoise noise;
    for (const double angle : {1e-9, 1e-5, 0.3, 1.5}) {
        for (int round = 0; round < 20; ++round) {
            const Eigen::Isometry3d from = noise.pose(50, 3);
            const Eigen::Isometry3d measured = noise.pose(5, 3);
            const Eigen::Isometry3d to = from * measured * noise.pose(angle, angle);
            const auto r = graph::residualOf(measured, from, to);
            EXPECT_LT((r.error - test::errorOf(measured, from, to)).norm(), 1e-12);
            const double h = 1e-6;
            for (int k = 0; k < 6; ++k) {
                const test::Vector6d d = h * test::Vector6d::Unit(k);
                const test::Vector6d byFrom = (test::errorOf(measured, test::moved(from, d), to) -
                                               test::errorOf(measured, test::moved(from, -d), to)) /
                                              (2 * h);
                const test::Vector6d byTo = (test::errorOf(measured, from, test::moved(to, d)) -
                                             test::errorOf(measured, from, test::moved(to, -d))) /
                                            (2 * h);
                EXPECT_LT((r.dFrom.col(k) - byFrom).norm(), 1e-7);
                EXPECT_LT((r.dTo.col(k) - byTo).norm(), 1e-7);
            }
        }
    }
}

using test::poseAt;

// Information of each kind, about a pose in general position, against what the same small change of
// the numbers costs in the tangent. Roll and yaw have unequal weights (MRPT's order is yaw first).
TEST(Information, MeansTheSameInOtherTerms) {
    using graph::InformationOf;
    const Eigen::Isometry3d Z = poseAt(1, -2, 0.5, 0.9, -0.4, 1.7);
    Matrix6 information = Matrix6::Zero();
    information.diagonal() << 10, 20, 30, 1000, 500, 4;
    information(3, 5) = information(5, 3) = 20;
    information(0, 4) = information(4, 0) = 15;
    const auto change = [](int k) { return 1e-5 * std::cos(5.0 * k); };
    Vector6 d;
    for (int k = 0; k < 6; ++k) d[k] = change(k);
    const auto costOf = [&](const Eigen::Isometry3d& changed) {
        const auto e = test::errorOf(Z, Eigen::Isometry3d::Identity(), changed);
        return test::edgeCost(e, information, 0);
    };

    const Matrix6 q = graph::convertInformation(information, Z, InformationOf::tangent,
                                                InformationOf::quaternion);
    EXPECT_EQ(q(3, 3), 4000);
    EXPECT_EQ(q(5, 5), 16);
    EXPECT_EQ(q(3, 5), 80);
    EXPECT_EQ(q(0, 4), 30);
    EXPECT_EQ(q(2, 2), 30);
    Eigen::Isometry3d half = Eigen::Isometry3d::Identity();
    half.linear() = Eigen::Quaterniond(std::sqrt(1 - d.tail<3>().squaredNorm()), d[3], d[4], d[5])
                        .toRotationMatrix();
    half.translation() = d.head<3>();
    const double byQuaternion = costOf(Z * half);
    EXPECT_NEAR(d.dot(q * d), byQuaternion, 1e-6 * byQuaternion);

    const Matrix6 angles = graph::convertInformation(information, Z, InformationOf::tangent,
                                                     InformationOf::yawPitchRoll);
    const double byAngles =
        costOf(poseAt(1 + d[0], -2 + d[1], 0.5 + d[2], 0.9 + d[3], -0.4 + d[4], 1.7 + d[5]));
    EXPECT_NEAR(d.dot(angles * d), byAngles, 1e-3 * byAngles);

    EXPECT_EQ(graph::convertInformation(q, Z, InformationOf::quaternion, InformationOf::tangent),
              information);
    EXPECT_LT(
        (graph::convertInformation(angles, Z, InformationOf::yawPitchRoll, InformationOf::tangent) -
         information)
            .norm(),
        1e-9);
}
}  // namespace
