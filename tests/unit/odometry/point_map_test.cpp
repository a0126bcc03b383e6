#include "odometry/point_map.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::PointMap;

Eigen::Matrix3Xd cloud(Eigen::Index count, double spread, test::Noise& noise) {
    Eigen::Matrix3Xd points(3, count);
    for (Eigen::Index i = 0; i < count; ++i) points.col(i) = spread * noise.normals();
    return points;
}

TEST(PointMap, FindsTheNearestAsBruteForceDoes) {
    test::Noise noise;
    PointMapOptions options;
    options.spacing = 0.01;  // nearly all points are kept
    PointMap map(options);
    const Eigen::Vector3d far(5000, -3000, 20);  // floats are taken about the cells
    const Eigen::Matrix3Xd points = cloud(2000, 4, noise).colwise() + far;
    for (Eigen::Index i = 0; i < points.cols(); ++i) map.add(points.col(i));
    EXPECT_GT(map.size(), 1900U);
    unsigned found = 0;
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d query = far + 4 * noise.normals();
        const auto [any, nearest, others_m] = map.nearest(query, 0.5);
        if (!any) continue;
        ++found;
        const double least = (points.colwise() - query).colwise().norm().minCoeff();
        // A full cell holds twenty points: one that it dropped may be nearer.
        EXPECT_GE((nearest - query).norm(), least - 1e-4);
        EXPECT_LE((nearest - query).norm(), 0.5);
    }
    EXPECT_GT(found, 30U);
}

TEST(PointMap, FindsTheNearestOfManyAsOfEach) {
    test::Noise noise;
    PointMap map(PointMapOptions{});
    map.add(cloud(3000, 3, noise));
    const Eigen::Matrix3Xd queries = cloud(150, 5, noise);  // also far from all points
    for (const double reach : {0.8, 10.0}) {
        const auto found = map.nearestOf(queries, reach);
        ASSERT_EQ(found.size(), 150U);
        std::size_t count = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const auto one = map.nearest(queries.col(static_cast<Eigen::Index>(i)), reach);
            EXPECT_EQ(found[i].any, one.any);
            EXPECT_EQ(found[i].point, one.point);
            EXPECT_EQ(found[i].others_m, one.others_m);
            count += one.any;
        }
        EXPECT_GT(count, 20U);
        EXPECT_LT(count, 150U);
    }
    EXPECT_TRUE(map.nearestOf(Eigen::Matrix3Xd(3, 0), 1).empty());
}

TEST(PointMap, OthersAreNoNearerThanItSays) {
    test::Noise noise;
    PointMapOptions options;
    options.spacing = 0.01;
    PointMap map(options);
    const Eigen::Matrix3Xd points = cloud(300, 1.5, noise);
    map.add(points);
    ASSERT_EQ(map.size(), 300U) << "one was left out";
    unsigned farther = 0;
    for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d query = 1.5 * noise.normals();
        const auto [any, nearest, others_m] = map.nearest(query, 0.8);
        const Eigen::RowVectorXd distances = (points.colwise() - query).colwise().norm();
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
            const bool isIt = any && (points.col(k) - nearest).norm() < 1e-5;
            EXPECT_TRUE(isIt || distances[k] >= others_m - 1e-4) << distances[k] << ' ' << others_m;
        }
        farther += any && others_m > (nearest - query).norm() + 0.05;
    }
    EXPECT_GT(farther, 30U);
}

TEST(PointMap, KeepsPointsThatAreApart) {
    PointMap map(PointMapOptions{});
    const Eigen::Matrix3Xd row =
        Eigen::Vector3d::UnitX() * Eigen::RowVectorXd::LinSpaced(91, 0, 0.9);
    map.add(row);  // every centimetre
    EXPECT_LE(map.size(), 5U);
    EXPECT_GE(map.size(), 4U);
    map.add(row);
    EXPECT_LE(map.size(), 5U);
}

TEST(PointMap, ForgetsWhatIsFarAway) {
    PointMap map(PointMapOptions{});
    map.add(Eigen::Vector3d(0, 0, 0));
    map.add(Eigen::Vector3d(500, 0, 0));
    map.forgetFarFrom({0, 0, 0});
    EXPECT_EQ(map.size(), 1U);
    EXPECT_TRUE(map.nearest({0.1, 0, 0}, 0.5).any);
    EXPECT_FALSE(map.nearest({500.1, 0, 0}, 0.5).any);
    map.clear();
    EXPECT_EQ(map.size(), 0U);
    EXPECT_FALSE(map.nearest({0.1, 0, 0}, 0.5).any);
}

TEST(PointMap, WhatTurnedOutToMoveIsErased) {
    PointMap map(PointMapOptions{});
    const Eigen::Vector3d stays(0.1, 0.1, 0.1), moves(0.8, 0.8, 0.8);
    map.add(moves);
    map.add(stays);
    map.erase(moves + Eigen::Vector3d(0.05, 0, 0));
    map.erase(Eigen::Vector3d(50, 0, 0));
    EXPECT_EQ(map.size(), 1U);
    EXPECT_TRUE(map.nearest(stays, 0.05).any);
    EXPECT_FALSE(map.nearest(moves, 0.3).any);
    map.add(moves);
    EXPECT_TRUE(map.nearest(moves, 0.05).any);
}
}  // namespace
