#include "graph/residual.h"

#include <gtest/gtest.h>

#include "gauss_newton.h"
#include "pose_graph_drive.h"

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
}  // namespace
