#include "odometry/search_points.h"

#include <gtest/gtest.h>

#include "delio/core/geometry.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Vector3d;
using odometry::LevelSquare;
using odometry::PointMap;

/** A place off the origin, of a sensor that hangs askew, with places a step apart about it. */
class LevelGrid : public ::testing::Test {
 protected:
    /** Where the middle of a cell is: sensor's frame. */
    Vector3d inSensor(int x, int y, int z) const {
        const Vector3d level(x + 0.5, y + 0.5, z + 0.5);
        return square_.upright.transpose().cast<double>() * (square_.step / 2 * level);
    }
    Eigen::Isometry3d placeAt(int x, int y) const {
        const Vector3d offset = square_.upright.transpose().cast<double>() *
                                Vector3d(square_.step * x, square_.step * y, 0);
        return square_.middle * Eigen::Translation3d(offset);
    }
    /** A patch of cells, some of which are taken: middles in the sensor's frame. */
    Eigen::Matrix3Xd someCells(int reach, int count) {
        Eigen::Matrix3Xd cells(3, count);
        for (int i = 0; i < count; ++i) {
            const Vector3d drawn = reach * noise_.normals();
            cells.col(i) = inSensor(static_cast<int>(drawn.x()), static_cast<int>(drawn.y()),
                                    static_cast<int>(drawn.z()) / 2);
        }
        return cells;
    }

    test::Noise noise_;
    const Eigen::Isometry3d middle_ = test::poseAt(41, -17, 3, 0.7);
    const Eigen::Matrix3f upright_ = rotationExp({0.4, -0.2, 0.1}).cast<float>();
    const LevelSquare square_{middle_, upright_, 0.8, 4};
    PointMap map_{{}};
};

// Where points lie in the middles of cells, cells that share a side are half a step apart.
TEST_F(LevelGrid, CountsAsLookingForEachPointFromEachPlaceDoes) {
    map_.add(middle_ * someCells(12, 1500));
    const Eigen::Matrix3Xd scan = someCells(10, 300);
    const auto counts = odometry::countsFrom(square_, map_, scan);
    ASSERT_EQ(counts.rows(), 9);
    ASSERT_EQ(counts.cols(), 9);
    for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y) {
            std::uint64_t near = 0;
            for (Eigen::Index i = 0; i < scan.cols(); ++i)
                near += map_.nearest(placeAt(x, y) * scan.col(i), 0.51 * square_.step).any;
            EXPECT_EQ(counts(x + 4, y + 4), near) << x << " " << y;
        }
}

TEST_F(LevelGrid, MostAreCountedWhereTheScanWasTaken) {
    const Eigen::Matrix3Xd seen = someCells(12, 500);
    map_.add(placeAt(-3, 2) * seen);
    const auto counts = odometry::countsFrom(square_, map_, seen);
    Eigen::Index x = 0, y = 0;
    EXPECT_EQ(counts.maxCoeff(&x, &y), 500U);
    EXPECT_EQ(x, 1);
    EXPECT_EQ(y, 6);
}

TEST_F(LevelGrid, WhatIsTooFarOrTooHighIsNotCountedAndTakesNoMemory) {
    Eigen::Matrix3Xd far(3, 4);
    far << 1e6, 0, 0, 1, 0, -1e6, 0, 1, 0, 0, 1e6, 1;
    map_.add(middle_ * far);
    const auto counts = odometry::countsFrom(square_, map_, far);
    EXPECT_EQ(counts(4, 4), 1U);
}

TEST_F(LevelGrid, NothingIsCountedOfNothing) {
    EXPECT_TRUE((odometry::countsFrom(square_, map_, someCells(5, 20)) == 0).all());
    map_.add(middle_ * someCells(5, 20));
    EXPECT_TRUE((odometry::countsFrom(square_, map_, Eigen::Matrix3Xd(3, 0)) == 0).all());
}
}  // namespace
