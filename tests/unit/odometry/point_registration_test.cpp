#include "odometry/register_points.h"

#include <gtest/gtest.h>

#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using odometry::PointMap;
using test::degreesBetween;
using test::poseAt;

/** A scan of few rings. */
const test::Sensor kSensor{16, 900, -15, 15, 0.02};

Eigen::Matrix3Xd scanFrom(const Eigen::Isometry3d& pose, double spacing, test::Noise& noise) {
    return voxelCentroids(test::ringScan(test::yard(), pose, kSensor, noise).points, spacing)
        .cast<double>();
}

PointMap mapOfYard(test::Noise& noise) {
    PointMap map(PointMapOptions{});
    map.add(scanFrom(Eigen::Isometry3d::Identity(), 0.25, noise));
    return map;
}

TEST(PointRegistration, FindsAScanOfFewRings) {
    test::Noise noise;
    const PointMap map = mapOfYard(noise);
    const Eigen::Isometry3d truth = poseAt(0.8, 0.1, 0.02, 0.03);
    const auto found = odometry::registerToPoints(map, scanFrom(truth, 1, noise), poseAt(0.5, 0, 0),
                                                  1, PointRegistrationOptions{});
    ASSERT_TRUE(found.valid);
    EXPECT_LT((found.pose.translation() - truth.translation()).norm(), 0.1);
    EXPECT_LT(degreesBetween(found.pose.linear(), truth.linear()), 0.5);
    EXPECT_GT(found.inlierRatio, 0.3);
}

// Decoupled: the rotation is taken about the centroids, wherever the scan is.
TEST(PointRegistration, TheSamePointsComeBackExactly) {
    test::Noise noise;
    PointMapOptions fine;
    fine.spacing = 0.01;
    PointMap map(fine);
    Eigen::Matrix3Xd points(3, 400);
    for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) = 20 * noise.normals();
    map.add(points);
    const Eigen::Isometry3d truth = poseAt(0.1, -0.05, 0.02, 0.005, -0.003, 0.002);
    PointRegistrationOptions options;
    options.converged_m = 1e-9;
    const auto found = odometry::registerToPoints(map, truth.inverse() * points,
                                                  Eigen::Isometry3d::Identity(), 0.5, options);
    ASSERT_TRUE(found.valid);
    EXPECT_LT((found.pose.matrix() - truth.matrix()).norm(), 1e-5);  // the map keeps floats
    EXPECT_EQ(found.inlierRatio, 1);
}

TEST(PointRegistration, WithTooFewPairsThePredictionStays) {
    test::Noise noise;
    const Eigen::Isometry3d predicted = poseAt(1, 2, 3, 0.1);
    const PointMap empty(PointMapOptions{});
    const auto nothing =
        odometry::registerToPoints(empty, scanFrom(predicted, 1, noise), predicted, 1, {});
    EXPECT_FALSE(nothing.valid);
    EXPECT_TRUE(nothing.pose.isApprox(predicted));
    const auto nobody =
        odometry::registerToPoints(mapOfYard(noise), Eigen::Matrix3Xd(3, 0), predicted, 1, {});
    EXPECT_FALSE(nobody.valid);
}

TEST(PointRegistration, PointsThatAreOffAreTold) {
    test::Noise noise;
    PointMap map(PointMapOptions{});
    Eigen::Matrix3Xd points(3, 3);
    points << 0, 10, 20, 0, 0, 0, 0, 0, 0;
    map.add(points.leftCols(2));
    const auto off = odometry::pointsOff(map, points, Eigen::Isometry3d::Identity(), 0.5);
    ASSERT_EQ(off.cols(), 1);
    EXPECT_EQ(off(0, 0), 20);
    const auto shareAt = [&](const Eigen::Matrix3Xd& of, double least) {
        return odometry::shareAt(map, of, Eigen::Isometry3d::Identity(), 0.5, least);
    };
    EXPECT_NEAR(shareAt(points, 0), 2.0 / 3, 1e-12);
    // A share that cannot be reached any more is not counted to the end.
    const Eigen::Matrix3Xd many = points.replicate(1, 100);
    EXPECT_EQ(shareAt(many, 0.66), shareAt(points, 0));
    EXPECT_EQ(shareAt(many, 0.9), 0);
}

using odometry::Pairing;

/** However it came to a pose, its pairs are the ones that are looked for from nothing. */
TEST(Pairing, DoesNotDependOnWhatWasAskedBefore) {
    test::Noise noise;
    odometry::PointMap map({});
    Eigen::Matrix3Xd points(3, 3000);
    for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) = 5 * noise.normals();
    map.add(points);
    for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) += 0.05 * noise.normals();
    // Some lie where the map has none, or none so near.
    for (Eigen::Index i = 0; i < points.cols(); i += 5) points.col(i) += 3 * noise.normals();
    Pairing used(map, points);
    double kernel = 0.4, step_m = 0.5;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 12; ++i, kernel *= 0.8, step_m *= 0.6) {
        Pairing fresh(map, points);
        const auto pairs = used.at(pose, kernel), expected = fresh.at(pose, kernel);
        ASSERT_EQ(pairs.size(), expected.size());
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            EXPECT_EQ(pairs[k].inMap, expected[k].inMap) << i;
            EXPECT_EQ(pairs[k].weight, expected[k].weight) << i;
        }
        pose.translation() += step_m * noise.normals();
        pose.linear() *= rotationExp(step_m / 10 * noise.normals());
    }
}
}  // namespace
