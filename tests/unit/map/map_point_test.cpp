#include "delio/map/map_point.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "point_support.h"
#include "poses.h"

namespace {
using namespace delio;
using test::expectEqual;
using test::pointAt;

TEST(MapEdit, MovesPlacesAndNormals) {
    map::MapPoints points = {pointAt(1, 2, 3)};
    points[0].normal = {1, 0, 0};
    points[0].intensity = 7;
    map::move(points, test::poseAtDeg(10, 20, 30, 90));
    EXPECT_LT((points[0].position - Eigen::Vector3f(8, 21, 33)).norm(), 1e-5);
    EXPECT_LT((points[0].normal - Eigen::Vector3f(0, 1, 0)).norm(), 1e-6);
    EXPECT_EQ(points[0].intensity, 7);
}

TEST(MapEdit, CropsWithItsBorders) {
    map::MapPoints points = {pointAt(0, 0, 0), pointAt(1, 1, 1), pointAt(1.1, 0, 0),
                             pointAt(0.5, -0.1, 0), pointAt(0.5, 0.5, 0.5)};
    map::crop(points, Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()));
    expectEqual(points, {pointAt(0, 0, 0), pointAt(1, 1, 1), pointAt(0.5, 0.5, 0.5)});
}

TEST(MapEdit, CutsAboveTheGroundOfAHill) {
    map::MapPoints points;
    for (int x = 0; x < 60; ++x)
        for (int y = 0; y < 15; ++y)
            for (const double z : {0.0, 2.5, 4.0}) points.push_back(pointAt(x, y, 0.02 * x + z));
    map::MapPoints dynamic = {pointAt(20, 7, 1.4), pointAt(20, 7, 4.4)};
    auto expected = points;
    expected.erase(std::remove_if(expected.begin(), expected.end(),
                                  [](const map::MapPoint& p) {
                                      return p.position.z() - 0.02F * p.position.x() > 3;
                                  }),
                   expected.end());
    map::cutAbove(points, dynamic, 3.2);
    expectEqual(points, expected);
    expectEqual(dynamic, {pointAt(20, 7, 1.4)});
    map::MapPoints none;
    map::cutAbove(none, none, 1);
    EXPECT_TRUE(none.empty());
}

TEST(MapEdit, ThinsToTheFirstOfEachVoxel) {
    map::MapPoints points = {pointAt(0.1, 0, 0), pointAt(0.9, 0.9, 0.9), pointAt(-0.1, 0, 0),
                             pointAt(1.1, 0, 0), pointAt(0.2, 0, 0)};
    auto all = points;
    map::thinOut(all, 0);
    expectEqual(all, points);
    map::thinOut(points, 1);
    expectEqual(points, {pointAt(0.1, 0, 0), pointAt(-0.1, 0, 0), pointAt(1.1, 0, 0)});
}
}  // namespace
