#include "paper/normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::estimateNormals;

/** Points of a square of 8 m on the plane through `centre`, 0.2 m apart, off it by `noise_m`. */
Eigen::Matrix3Xf square(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal,
                        double noise_m) {
    test::Noise noise;
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    Eigen::Matrix3Xf points(3, 41 * 41);
    for (int i = 0; i < 41; ++i)
        for (int j = 0; j < 41; ++j)
            points.col(41 * i + j) = (centre + 0.2 * (i - 20) * u + 0.2 * (j - 20) * v +
                                      noise_m * noise.normal() * normal)
                                         .cast<float>();
    return points;
}

Eigen::Matrix3Xf together(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b) {
    Eigen::Matrix3Xf both(3, a.cols() + b.cols());
    both << a, b;
    return both;
}

// A centroid is off by 5 to 10 mm, its 12 neighbours reach about 0.35 m (rms) along either axis:
// a normal is off by about 0.01 / (0.35 sqrt(12)) rad, half a degree.
TEST(Normals, OfANoisyPlaneAreThePlanes) {
    const Eigen::Vector3d normal = Eigen::Vector3d(-0.8, 0.3, 0.4).normalized();
    const auto normals = estimateNormals(square(-9 * normal, normal, 0.01), {});
    EXPECT_GT(normals.directions.cols(), 300);
    EXPECT_GT(static_cast<double>(normals.directions.cols()),
              0.95 * static_cast<double>(normals.neighbourhoods));
    ASSERT_EQ(normals.planarity.size(), normals.directions.cols());
    double sum = 0;
    for (Eigen::Index i = 0; i < normals.directions.cols(); ++i) {
        const Eigen::Vector3d n = normals.directions.col(i).cast<double>();
        EXPECT_NEAR(n.norm(), 1, 1e-5);
        const double degrees = std::acos(std::min(1.0, n.dot(normal))) * 180 / M_PI;
        EXPECT_LT(degrees, 5);  // so each is turned towards the sensor, too
        sum += degrees * degrees;
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(normals.directions.cols())), 1);
    EXPECT_GT(normals.planarity.minCoeff(), 0.8F);
    EXPECT_LE(normals.planarity.maxCoeff(), 1.0F);
}

TEST(Normals, LookAtTheSensorFromEverySide) {
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
        for (const double side : {-1.0, 1.0}) {
            const auto normals = estimateNormals(square(6 * side * axis, axis, 0.002), {});
            ASSERT_GT(normals.directions.cols(), 300);
            for (Eigen::Index i = 0; i < normals.directions.cols(); ++i)
                EXPECT_LT(side * normals.directions.col(i).cast<double>().dot(axis), -0.99);
        }
}

TEST(Normals, ThickerPlanesAreLessPlanar) {
    const Eigen::Vector3d normal(0, 0, 1);
    const auto thin = estimateNormals(square({0, 0, -6}, normal, 0.005), {});
    const auto thick = estimateNormals(square({0, 0, -6}, normal, 0.03), {});
    EXPECT_GT(thin.planarity.mean(), thick.planarity.mean() + 0.02F);
}

TEST(Normals, OneRingIsALineAndNoSurface) {
    Eigen::Matrix3Xf ring(3, 1200), straight(3, 200);
    test::Noise noise;
    for (int i = 0; i < 1200; ++i)
        ring.col(i) << static_cast<float>(15 * std::cos(i * M_PI / 600)),
            static_cast<float>(15 * std::sin(i * M_PI / 600)), -1.7F;
    for (int i = 0; i < 200; ++i)
        straight.col(i) << 8, static_cast<float>(i) * 0.05F - 5,
            static_cast<float>(0.002 * noise.normal());
    for (const auto& points : {ring, straight}) {
        const auto normals = estimateNormals(points, {});
        EXPECT_GT(normals.neighbourhoods, 20U);
        EXPECT_EQ(normals.lines, normals.neighbourhoods);
        EXPECT_EQ(normals.directions.cols(), 0);
        EXPECT_EQ(normals.planarity.size(), 0);
    }
}

TEST(Normals, ABallOfPointsIsRough) {
    test::Noise noise;
    Eigen::Matrix3Xf points(3, 4000);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) = (Eigen::Vector3d(10, 0, 0) +
                         2 * std::cbrt(0.5 + noise.uniform() / 2) * noise.direction())
                            .cast<float>();
    const auto normals = estimateNormals(points, {});
    EXPECT_GT(normals.neighbourhoods, 300U);
    EXPECT_GT(static_cast<double>(normals.rough),
              0.97 * static_cast<double>(normals.neighbourhoods));
}

TEST(Normals, EveryNeighbourhoodIsCountedOnce) {
    test::Noise noise;
    const auto scan = test::ringScan(test::yard(), Eigen::Isometry3d::Identity(), {}, noise);
    const auto normals = estimateNormals(scan.points, {});
    EXPECT_GT(normals.lines, 0U);
    EXPECT_GT(normals.rough, 0U);
    EXPECT_EQ(normals.lines + normals.rough + static_cast<std::size_t>(normals.directions.cols()),
              normals.neighbourhoods);
}

TEST(Normals, FourPointsAreTooFew) {
    Eigen::Matrix3Xf points(3, 5);
    points << 0, 0.5F, 0, 0.5F, 1.1F,  //
        0, 0, 0.5F, 0.5F, 0.9F,        //
        -5, -5, -5, -5, -5;
    for (Eigen::Index count = 1; count < 5; ++count) {
        const auto normals = estimateNormals(points.leftCols(count), {});
        EXPECT_EQ(normals.directions.cols(), 0);
        EXPECT_EQ(normals.rough, static_cast<std::size_t>(count));
    }
    const auto five = estimateNormals(points, {});
    ASSERT_EQ(five.directions.cols(), 5);
    EXPECT_GT(five.directions.row(2).minCoeff(), 0.999F);
}

TEST(Normals, OfAPartOfTheVoxelsAreThoseOfAll) {
    const auto points = square({0, 0, -6}, {0, 0, 1}, 0.01);
    const auto all = estimateNormals(points, {}), part = estimateNormals(points, {}, 50);
    EXPECT_LE(part.neighbourhoods, 50U);
    EXPECT_GT(part.directions.cols(), 25);
    for (Eigen::Index i = 0, k = 0; i < part.directions.cols(); ++i) {
        while (all.voxels[k] != part.voxels[i]) ASSERT_LT(++k, all.voxels.cols());
        EXPECT_EQ(part.directions.col(i), all.directions.col(k));
        EXPECT_EQ(part.points.col(i), all.points.col(k));
    }
}

TEST(Normals, NeighboursBeyondTheRadiusAreNotUsed) {
    NormalsOptions options;
    options.max_radius = 0.55;
    // Within that radius there are the point itself and four others; without one, too few.
    // (No point on the border of two voxels.)
    const auto grid = square({0.05, 0.05, -6}, {0, 0, 1}, 0);
    const auto all = estimateNormals(grid, options);
    EXPECT_GT(all.directions.cols(), 100);
    options.max_radius = 0.3;
    EXPECT_EQ(estimateNormals(grid, options).directions.cols(), 0);
}

TEST(Normals, DuplicatesChangeNothing) {
    const auto points = square({0, 0, -6}, {0, 0, 1}, 0.01);
    const auto once = estimateNormals(points, {}),
               thrice = estimateNormals(together(points, together(points, points)), {});
    ASSERT_EQ(once.directions.cols(), thrice.directions.cols());
    EXPECT_LT((once.directions - thrice.directions).cwiseAbs().maxCoeff(), 1e-3F);

    const auto same = estimateNormals(Eigen::Vector3f(5, 5, 5).replicate(1, 1000), {});
    EXPECT_EQ(same.neighbourhoods, 1U);
    EXPECT_EQ(same.directions.cols(), 0);
}

TEST(Normals, Empty) {
    const auto normals = estimateNormals({}, {});
    EXPECT_EQ(normals.directions.cols(), 0);
    EXPECT_EQ(normals.neighbourhoods, 0U);
}
}  // namespace
