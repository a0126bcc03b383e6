#include "odometry/register_points.h"

#include <gtest/gtest.h>

#include "delio/core/geometry.h"
#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
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
