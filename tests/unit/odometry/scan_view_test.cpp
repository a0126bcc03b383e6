#include "odometry/deskew.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {

Eigen::Matrix3Xf anyPoints(Eigen::Index count) {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, count);
    for (Eigen::Index i = 0; i < count; ++i) points.col(i) = (20 * noise.direction()).cast<float>();
    return points;
}

Twist movingAt(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning) {
    Twist motion;
    motion.velocity = velocity;
    motion.turning = turning;
    return motion;
}

TEST(ScanView, PointsWithoutTimesStayAsTheyAre) {
    odometry::PointCloud cloud;
    cloud.points = anyPoints(50);
    const ScanView view = undistorted(cloud, movingAt({20, 1, 0}, {0, 0, 1}));
    EXPECT_EQ(view.points, cloud.points);
    EXPECT_EQ(view.dynamic, std::vector<std::uint8_t>(50, 0));
    EXPECT_EQ(view.fine.cols() + view.thinned.cols(), 0);
}

TEST(ScanView, PointsWithTimesComeToWhereTheyAreAtTheStamp) {
    odometry::PointCloud cloud;
    cloud.points = anyPoints(3);
    cloud.times_s = {-0.05F, 0, 0.025F};
    // Straight on: by the way to the stamp.
    const ScanView straight = undistorted(cloud, movingAt({20, -2, 0}, {0, 0, 0}));
    for (Eigen::Index i = 0; i < 3; ++i) {
        const float time_s = cloud.times_s[static_cast<std::size_t>(i)];
        const Eigen::Vector3f expected = cloud.points.col(i) + time_s * Eigen::Vector3f(20, -2, 0);
        EXPECT_LT((straight.points.col(i) - expected).norm(), 1e-5F);
    }
    EXPECT_EQ(straight.dynamic, std::vector<std::uint8_t>(3, 0));
    // On the spot: by the angle.
    const ScanView turned = undistorted(cloud, movingAt({0, 0, 0}, {0, 0, 2}));
    for (Eigen::Index i = 0; i < 3; ++i) {
        const double angle = 2 * double{cloud.times_s[static_cast<std::size_t>(i)]};
        const Eigen::Vector3d expected =
            test::poseAt(0, 0, 0, angle) * cloud.points.col(i).cast<double>();
        EXPECT_LT((turned.points.col(i).cast<double>() - expected).norm(), 1e-5);
    }
}

TEST(ScanView, OfNoPointsIsEmpty) {
    ScanView view = undistorted({}, Twist{});
    thinForMap(view, 0.25);
    numberForPlanes(view, 0.5);
    thinForPlanes(view);
    EXPECT_EQ(view.points.cols() + view.fine.cols() + view.thinned.cols(), 0);
    EXPECT_TRUE(view.dynamic.empty());
}

TEST(ScanView, UnmarkedPointsKeepTheirOrder) {
    const auto points = anyPoints(4);
    Eigen::Matrix3Xf expected(3, 2);
    expected << points.col(1), points.col(2);
    EXPECT_EQ(unmarked(points, {1, 0, 0, 1}), expected);
    EXPECT_EQ(unmarked(points, {0, 0, 0, 0}), points);
    EXPECT_EQ(unmarked(points, {1, 1, 1, 1}).cols(), 0);
    EXPECT_EQ(unmarked(Eigen::Matrix3Xf(3, 0), {}).cols(), 0);
}

/** On a line: voxels of a metre, then of four. The points at 6.5 and 6.7 are dynamic. */
ScanView viewOfALine(const odometry::PointCloud& cloud) {
    ScanView view = undistorted(cloud, Twist{});
    thinForMap(view, 1);
    thinForPoints(view, Eigen::Matrix3f::Identity(), 2, false);
    numberForPlanes(view, 4);
    leaveOutDynamic(view, {0, 0, 1, 0});
    thinForPlanes(view);
    return view;
}

odometry::PointCloud line() {
    odometry::PointCloud cloud;
    cloud.points.resize(3, 7);
    cloud.points << 0.2F, 0.4F, 1.5F, 0.9F, 6.5F, 6.7F, 8.5F,  //
        0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F,              //
        0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F;
    cloud.times_s = {0, 1, 2, 3, 4, 5, 6};
    return cloud;
}

TEST(ScanView, ThinningTakesCentroidsTwice) {
    const odometry::PointCloud cloud = line();
    const ScanView view = viewOfALine(cloud);
    EXPECT_EQ(view.points, cloud.points);
    EXPECT_EQ(view.dynamic, (std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1, 0}));
    ASSERT_EQ(view.fine.cols(), 3);
    EXPECT_FLOAT_EQ(view.fine(0, 0), 0.5F);
    EXPECT_FLOAT_EQ(view.fine(0, 1), 1.5F);
    EXPECT_FLOAT_EQ(view.fine(0, 2), 8.5F);
    ASSERT_EQ(view.thinned.cols(), 2);
    EXPECT_NEAR(view.thinned(0, 0), 1, 1e-6);  // of the centroids: not (0.2 + 0.4 + 0.9 + 1.5) / 4
    EXPECT_NEAR(view.thinned(0, 1), 8.5, 1e-6);
}

TEST(ScanView, PointsForPlanesLeaveDynamicOnesOut) {
    EXPECT_EQ(firstsForPlanes(viewOfALine(line())), (std::vector<Eigen::Index>{0, 6}));
}

TEST(ScanView, PointsKeepTheirVoxelsWhenUndistortedAgain) {
    const odometry::PointCloud cloud = line();
    const ScanView view = viewOfALine(cloud),
                   again = undistortedAgain(cloud, movingAt({0.1, 0, 0}, {0, 0, 0}), view);
    EXPECT_EQ(again.points, undistorted(cloud, movingAt({0.1, 0, 0}, {0, 0, 0})).points);
    EXPECT_EQ(again.dynamic, view.dynamic);
    ASSERT_EQ(again.fine.cols(), 3);
    EXPECT_FLOAT_EQ(again.fine(0, 0), (0.2F + 0.5F + 1.2F) / 3);
    EXPECT_FLOAT_EQ(again.fine(0, 1), 1.7F);
    EXPECT_FLOAT_EQ(again.fine(0, 2), 9.1F);
    ASSERT_EQ(again.thinned.cols(), 2);
    EXPECT_NEAR(again.thinned(0, 0), (1.9 / 3 + 1.7) / 2, 1e-6);
    // Thinned for points: the first voxel of two metres, and without the dynamic one the last.
    EXPECT_EQ(view.coarse.cols(), 3);
    ASSERT_EQ(again.coarse.cols(), 2);
    EXPECT_EQ(again.coarse.col(0), again.fine.col(0).cast<double>());
    EXPECT_EQ(again.coarse.col(1), again.fine.col(2).cast<double>());
}

// At 1 m/s the points at 0.2, 0.4 and 0.9, which shared a voxel, come to 0.2, 1.4 and 3.9.
TEST(ScanView, VoxelsAreNewWhereAnotherMotionPartsTheirPoints) {
    const odometry::PointCloud cloud = line();
    const Twist motion = movingAt({1, 0, 0}, {0, 0, 0});
    const ScanView view = viewOfALine(cloud),
                   anew = undistortedAnew(cloud, motion, view.dynamic, 1, 4);
    EXPECT_EQ(anew.points, undistorted(cloud, motion).points);
    EXPECT_EQ(anew.dynamic, view.dynamic);
    ASSERT_EQ(anew.fine.cols(), 4);
    const Eigen::RowVector4f expected(0.2F, 1.4F, (3.5F + 3.9F) / 2, 14.5F);
    EXPECT_LT((anew.fine.row(0) - expected).norm(), 1e-5F);
    ASSERT_EQ(anew.thinned.cols(), 2);
    EXPECT_NEAR(anew.thinned(0, 0), (0.2 + 1.4 + 3.7) / 3, 1e-6);
}
}  // namespace
