#include "odometry/deskew.h"

#include <gtest/gtest.h>

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
    thin(view, 0.25, 0.5);
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

TEST(ScanView, ThinningTakesCentroidsOfStaticPointsTwice) {
    ScanView view;
    // On a line: voxels of a metre, then of four.
    view.points.resize(3, 6);
    view.points << 0.2F, 0.4F, 1.5F, 0.9F, 6.5F, 2.5F,  //
        0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F,             //
        0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F;
    view.dynamic = {0, 0, 0, 1, 0, 1};  // 0.9 and 2.5 drive
    const auto before = view.points;
    thin(view, 1, 4);
    EXPECT_EQ(view.points, before);
    ASSERT_EQ(view.fine.cols(), 3);
    EXPECT_FLOAT_EQ(view.fine(0, 0), 0.3F);
    EXPECT_FLOAT_EQ(view.fine(0, 1), 1.5F);
    EXPECT_FLOAT_EQ(view.fine(0, 2), 6.5F);
    ASSERT_EQ(view.thinned.cols(), 2);
    EXPECT_NEAR(view.thinned(0, 0), 0.9, 1e-6);  // of the centroids: not (0.2 + 0.4 + 1.5) / 3
    EXPECT_NEAR(view.thinned(0, 1), 6.5, 1e-6);
}
}  // namespace
