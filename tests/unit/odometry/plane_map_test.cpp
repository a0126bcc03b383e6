#include "odometry/plane_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::PlaneMap;

/** Points of the plane n.(p - q) = 0 about q, off it by `sigma`. */
Eigen::Matrix3Xd patch(const Eigen::Vector3d& q, const Eigen::Vector3d& normal, double sigma,
                       Eigen::Index count, test::Noise& noise) {
    const Eigen::Vector3d n = normal.normalized(), u = n.unitOrthogonal(), v = n.cross(u);
    Eigen::Matrix3Xd points(3, count);
    for (Eigen::Index i = 0; i < count; ++i)
        points.col(i) =
            q + 0.4 * noise.uniform() * u + 0.4 * noise.uniform() * v + sigma * noise.normal() * n;
    return points;
}

/** Voxels of one size, which the patches fill. */
PlaneMapOptions oneMetre() {
    PlaneMapOptions options;
    options.voxel_size = 1;
    options.levels = 1;
    options.ground_levels = 0;
    options.min_breadth = 0.1;
    return options;
}

TEST(PlaneMap, APlaneComesBackWithItsThickness) {
    test::Noise noise;
    PlaneMap map(oneMetre());
    // Far from the origin: sums are taken about the voxel's first point.
    const Eigen::Vector3d middle(4000.5, -3000.5, 20.5),
        normal = Eigen::Vector3d(1, 2, 3).normalized();
    map.add(patch(middle, normal, 0.02, 200, noise));
    const auto* plane = map.at(middle);
    ASSERT_TRUE(plane);
    EXPECT_GT(std::abs(plane->normal().dot(normal)), std::cos(0.02));
    EXPECT_NEAR(std::sqrt(plane->variance), 0.02, 0.005);
    EXPECT_LT((plane->mean - middle).norm(), 0.1);
    EXPECT_GT(plane->count, 100);
    // A point in the middle of the plane is known to its thickness, one beside it less well.
    const double there = plane->varianceAt(plane->along(plane->mean));
    EXPECT_NEAR(there / plane->variance, 1 + 1 / plane->count, 1e-9);
    const Eigen::Vector3d beside = plane->along(plane->mean + 3 * plane->axes.col(2));
    EXPECT_NEAR(beside[2], 3, 1e-9);
    EXPECT_NEAR(plane->varianceAt(beside) - there, 9 * plane->tilts[1], 1e-12);
}

TEST(PlaneMap, PointsInTwoCallsAreOnePlane) {
    test::Noise noise;
    const auto points = patch({0.5, 0.5, 0.5}, {0, 0, 1}, 0.01, 100, noise);
    PlaneMap once(oneMetre()), twice(oneMetre());
    once.add(points);
    twice.add(points.leftCols(40));
    twice.add(points.rightCols(60));
    const auto *a = once.at({0.5, 0.5, 0.5}), *b = twice.at({0.5, 0.5, 0.5});
    ASSERT_TRUE(a && b);
    // To what rounding leaves: sums are taken from the first point of each call.
    EXPECT_TRUE(a->mean.isApprox(b->mean, 1e-14)) << (a->mean - b->mean).norm();
    EXPECT_NEAR(a->variance, b->variance, 1e-11 * a->variance);
    EXPECT_TRUE(a->tilts.isApprox(b->tilts, 1e-11)) << (a->tilts - b->tilts).norm();
    EXPECT_EQ(a->count, b->count);
}

TEST(PlaneMap, PlanesThatAreFittedAheadAreTheSame) {
    test::Noise noise;
    PlaneMap asked(oneMetre()), ahead(oneMetre());
    const auto expectSame = [&](double x) {
        const auto *a = asked.at({x, 0.5, 0.5}), *b = ahead.at({x, 0.5, 0.5});
        ASSERT_EQ(a != nullptr, b != nullptr) << x;
        if (!a) return;
        EXPECT_EQ(a->mean, b->mean);
        EXPECT_EQ(a->axes, b->axes);
        EXPECT_EQ(a->tilts, b->tilts);
        EXPECT_EQ(a->count, b->count);
    };
    for (const double x : {0.5, 5.5, 5.5, 90.5}) {
        const auto points = patch({x, 0.5, 0.5}, {0, 0, 1}, 0.01, 60, noise);
        asked.add(points);
        ahead.add(points);
        ahead.fitLatest();
        expectSame(x);
    }
    for (PlaneMap* map : {&asked, &ahead}) map->forgetFarFrom({90, 0, 0});
    ahead.fitLatest();
    for (const double x : {0.5, 5.5, 90.5}) expectSame(x);
    ahead.erase(patch({90.5, 0.5, 0.5}, {0, 0, 1}, 0.01, 60, noise));
    ahead.fitLatest();
    EXPECT_FALSE(ahead.at({90.5, 0.5, 0.5}));
}

TEST(PlaneMap, WhatIsNoPlaneIsNone) {
    test::Noise noise;
    PlaneMap map(oneMetre());
    Eigen::Matrix3Xd ball(3, 100), line(3, 100);
    for (Eigen::Index i = 0; i < 100; ++i) {
        ball.col(i) = Eigen::Vector3d(0.5, 0.5, 0.5) + 0.1 * noise.normals();
        line.col(i) << 5 + 0.01 * static_cast<double>(i), 0.5, 0.5;
    }
    map.add(ball);
    map.add(line);
    map.add(patch({10.5, 0.5, 0.5}, {0, 0, 1}, 0.01, 5, noise));  // too few
    EXPECT_FALSE(map.at({0.5, 0.5, 0.5}));
    EXPECT_FALSE(map.at({5.5, 0.5, 0.5}));
    EXPECT_FALSE(map.at({10.5, 0.5, 0.5}));
    EXPECT_FALSE(map.at({50, 50, 50}));
}

// Rows that one ring draws on a wall lie in any number of planes.
TEST(PlaneMap, ARowOfPointsIsNone) {
    test::Noise noise;
    PlaneMap map(PlaneMapOptions{});
    Eigen::Matrix3Xd rows(3, 200);
    for (Eigen::Index i = 0; i < rows.cols(); ++i)
        rows.col(i) << 0.05 + 0.0045 * static_cast<double>(i), 0.5 + 0.01 * noise.normal(),
            i % 2 ? 0.45 : 0.55;
    map.add(rows);
    EXPECT_FALSE(map.at({0.5, 0.5, 0.5}));
}

TEST(PlaneMap, WhereTheSmallVoxelHasNoPlaneTheLargerOneMay) {
    test::Noise noise;
    PlaneMap map(PlaneMapOptions{});
    Eigen::Matrix3Xd sparse(3, 16);  // every 25 cm
    for (Eigen::Index i = 0; i < sparse.cols(); ++i)
        sparse.col(i) << 0.125 + 0.25 * static_cast<double>(i % 4),
            0.125 + 0.25 * static_cast<double>(i / 4), 0.25 + 0.001 * noise.normal();
    map.add(sparse);
    EXPECT_EQ(map.planes(), 1U);
    ASSERT_TRUE(map.at({0.3, 0.3, 0.25}));
    EXPECT_EQ(map.at({0.3, 0.3, 0.25})->count, 16);
    const Eigen::Vector3d inside(0.3, 0.3, 0.25), beside(0.8, 0.8, 0.25);
    EXPECT_EQ(map.at(inside), map.at(beside));
    PlaneMapOptions narrow;
    narrow.min_breadth = 0.1;
    PlaneMap dense(narrow);
    dense.add(sparse);
    dense.add(0.5 * patch({0.5, 0.5, 0.5}, {0, 0, 1}, 0.001, 30, noise));  // in one small voxel
    ASSERT_TRUE(dense.at(inside));
    EXPECT_NE(dense.at(inside), dense.at(beside));
    map.clear(Eigen::Vector3d::UnitZ());
    EXPECT_EQ(map.planes(), 0U);
    EXPECT_EQ(map.voxels(), 0U);
}

// Two rings on the ground, 1.2 m apart, and on a wall.
TEST(PlaneMap, BetweenRingsThatLieFarApartIsGroundOrNothing) {
    test::Noise noise;
    Eigen::Matrix3Xd ground(3, 80), wall(3, 80);
    for (Eigen::Index i = 0; i < ground.cols(); ++i) {
        const double along = 0.05 * static_cast<double>(i / 2), across = i % 2 ? 0.4 : 1.6;
        ground.col(i) << along, across, 0.5 + 0.01 * noise.normal();
        wall.col(i) << along + 10, 0.5 + 0.01 * noise.normal(), across;
    }
    const Eigen::Vector3d onGround(1, 1, 0.5), onWall(11, 0.5, 1);
    PlaneMap upright(PlaneMapOptions{});
    upright.add(ground);
    upright.add(wall);
    ASSERT_TRUE(upright.at(onGround));
    EXPECT_GT(std::abs(upright.at(onGround)->normal().z()), 0.99);
    EXPECT_FALSE(upright.at(onWall));
    PlaneMap rolled(PlaneMapOptions{}, Eigen::Vector3d::UnitY());
    rolled.add(ground);
    rolled.add(wall);
    EXPECT_FALSE(rolled.at(onGround));
    EXPECT_TRUE(rolled.at(onWall));
}

TEST(PlaneMap, AFullVoxelStaysAndAFarOneGoes) {
    test::Noise noise;
    PlaneMapOptions options = oneMetre();
    options.max_points = 50;
    options.radius = 20;
    PlaneMap map(options);
    map.add(patch({0.5, 0.5, 0.4}, {0, 0, 1}, 0.001, 60, noise));
    map.add(patch({0.5, 0.5, 0.6}, {0, 0, 1}, 0.001, 60, noise));
    ASSERT_TRUE(map.at({0.5, 0.5, 0.5}));
    EXPECT_NEAR(map.at({0.5, 0.5, 0.5})->mean.z(), 0.4, 0.001);
    map.add(patch({30.5, 0.5, 0.5}, {0, 0, 1}, 0.001, 60, noise));
    map.forgetFarFrom({25, 0, 0});
    EXPECT_FALSE(map.at({0.5, 0.5, 0.5}));
    EXPECT_TRUE(map.at({30.5, 0.5, 0.5}));
    map.forgetFarFrom({1000, 0, 0});
    EXPECT_EQ(map.voxels(), 0U);
}

TEST(PlaneMap, WhatTurnedOutToMoveIsErasedAndTheGroundStays) {
    test::Noise noise;
    PlaneMap map(oneMetre());
    const Eigen::Vector3d side(0.5, 0.5, 1.5), beside(3.5, 0.5, 1.5);
    const Eigen::Matrix3Xd seen = patch(side, {1, 0, 0}, 0.001, 60, noise);
    map.add(seen);
    map.add(patch(beside, {1, 0, 0}, 0.001, 60, noise));
    ASSERT_TRUE(map.at(side));
    map.erase(seen);
    EXPECT_FALSE(map.at(side));
    EXPECT_TRUE(map.at(beside));
    map.erase(Eigen::Vector3d(100, 0, 0));  // nothing was there
    map.add(patch(side, {0, 1, 0}, 0.001, 60, noise));
    ASSERT_TRUE(map.at(side));  // what stands there now
    EXPECT_GT(std::abs(map.at(side)->normal().y()), 0.99);
    map.forgetFarFrom({1000, 0, 0});
    EXPECT_EQ(map.voxels(), 0U);
}
}  // namespace
