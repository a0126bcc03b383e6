#include "paper/mean_shift.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "paper/sphere.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using paper::Mode;
using paper::seekModes;
using paper::sphereExp;
using paper::sphereGrid;
using paper::sphereLog;

constexpr double kDeg = M_PI / 180;

double degrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) / kDeg;
}

/** `each` normals about each axis, then `scattered` anywhere. */
paper::SurfaceNormals planted(const std::vector<Eigen::Vector3d>& axes,
                              const std::vector<Eigen::Index>& each, double spread_deg,
                              Eigen::Index scattered) {
    test::Noise noise;
    std::vector<Eigen::Vector3f> all;
    for (std::size_t a = 0; a < axes.size(); ++a)
        for (Eigen::Index i = 0; i < each[a]; ++i)
            all.push_back(
                (axes[a] + spread_deg * kDeg * noise.normals()).normalized().cast<float>());
    for (Eigen::Index i = 0; i < scattered; ++i) all.push_back(noise.direction().cast<float>());
    paper::SurfaceNormals normals;
    normals.directions.resize(3, static_cast<Eigen::Index>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i)
        normals.directions.col(static_cast<Eigen::Index>(i)) = all[i];
    normals.planarity = Eigen::VectorXf::Ones(normals.directions.cols());
    return normals;
}

std::vector<Eigen::Vector3d> fourAxes() {
    return {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.8, -0.6, 0).normalized(),
            Eigen::Vector3d(-0.7, 0.1, 0.3).normalized(),
            Eigen::Vector3d(0.1, 0.9, -0.5).normalized()};
}

TEST(Sphere, ExpAndLogUndoEachOther) {
    test::Noise noise;
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d at = noise.direction(), n = noise.direction();
        const Eigen::Vector3d tangent = sphereLog(at, n);
        EXPECT_NEAR(tangent.dot(at), 0, 1e-12);
        EXPECT_NEAR(tangent.norm(), degrees(at, n) * kDeg, 1e-12);
        EXPECT_LT((sphereExp(at, tangent) - n).norm(), 1e-12);
    }
    const Eigen::Vector3d up(0, 0, 1);
    EXPECT_EQ(sphereLog(up, up), Eigen::Vector3d(0, 0, 0));
    EXPECT_EQ(sphereExp(up, Eigen::Vector3d(0, 0, 0)), up);
    EXPECT_NEAR(sphereLog(up, -up).norm(), M_PI, 1e-12);
    EXPECT_LT((sphereExp(up, sphereLog(up, -up)) + up).norm(), 1e-12);
}

// Where the tangent is zero, both maps are the identity to first order.
TEST(Sphere, DerivativesOfExpAndLogAreThoseOfTheProjection) {
    test::Noise noise;
    constexpr double h = 1e-6;
    for (int i = 0; i < 20; ++i) {
        const Eigen::Vector3d at = noise.direction();
        const Eigen::Matrix3d project = Eigen::Matrix3d::Identity() - at * at.transpose();
        for (int k = 0; k < 3; ++k) {
            const Eigen::Vector3d along = project.col(k);
            const Eigen::Vector3d exp =
                (sphereExp(at, h * along) - sphereExp(at, -h * along)) / (2 * h);
            EXPECT_LT((exp - along).norm(), 1e-9);
            const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
            const Eigen::Vector3d log = (sphereLog(at, (at + step).normalized()) -
                                         sphereLog(at, (at - step).normalized())) /
                                        (2 * h);
            EXPECT_LT((log - along).norm(), 1e-9);
        }
    }
}

TEST(Sphere, TheGridCoversAllOfIt) {
    test::Noise noise;
    const Eigen::Matrix3Xd grid = sphereGrid(10);
    EXPECT_LT(grid.cols(), 600);
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d n = noise.direction();
        EXPECT_LT(std::acos(std::min(1.0, (grid.transpose() * n).maxCoeff())) / kDeg, 8);
    }
}

TEST(MeanShift, FindsPlantedModesAmongScatteredNormals) {
    const auto axes = fourAxes();
    const auto normals = planted(axes, {2000, 300, 100, 60}, 2, 300);
    MeanShiftOptions options;
    options.min_support = 30;
    const auto modes = seekModes(normals.directions, options);
    ASSERT_EQ(modes.size(), 4U);
    // The best supported comes first; 60 normals of 2 deg fix a mean to 0.26 deg a direction.
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(degrees(modes[i].direction, axes[i]), 0.8);
    EXPECT_GE(modes[0].support, 1990U);
}

/** The density that mean shift climbs, by summing over all normals of the window. */
double densityAt(const Eigen::Matrix3Xf& directions, const Eigen::Vector3d& at, double window) {
    const double c = -std::log(0.01) / (window * window / 4);
    double sum = 0;
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
        const double angle = degrees(at, directions.col(i).cast<double>()) * kDeg;
        if (angle < window / 2) sum += std::exp(-c * angle * angle);
    }
    return sum;
}

TEST(MeanShift, ModesAreMaximaOfTheDensityByBruteForce) {
    const auto normals = planted(fourAxes(), {400, 200, 200, 200}, 4, 100);
    MeanShiftOptions options;
    options.min_support = 50;
    const auto modes = seekModes(normals.directions, options);
    ASSERT_GE(modes.size(), 4U);
    const double window = options.window_deg * kDeg;
    for (std::size_t m = 0; m < 4; ++m) {
        const double here = densityAt(normals.directions, modes[m].direction, window);
        // Nowhere on a ring of 2 deg is it denser; a jump at the window's edge is 1 % a normal.
        for (double azimuth = 0; azimuth < 6.2; azimuth += 0.3) {
            const Eigen::Vector3d u = modes[m].direction.unitOrthogonal();
            const Eigen::Vector3d v = modes[m].direction.cross(u);
            const Eigen::Vector3d aside = sphereExp(
                modes[m].direction, 2 * kDeg * (std::cos(azimuth) * u + std::sin(azimuth) * v));
            EXPECT_LT(densityAt(normals.directions, aside, window), here);
        }
    }
}

// The cone |n x f| < sin(theta/2) of the paper also holds the antipode.
TEST(MeanShift, TheAntipodeIsAnotherMode) {
    const auto normals = planted({{0, 0, 1}, {0, 0, -1}}, {300, 100}, 2, 0);
    const auto modes = seekModes(normals.directions, {});
    ASSERT_EQ(modes.size(), 2U);
    EXPECT_LT(degrees(modes[0].direction, {0, 0, 1}), 0.5);
    EXPECT_LT(degrees(modes[1].direction, {0, 0, -1}), 0.8);
    EXPECT_EQ(modes[0].support, 300U);
    EXPECT_EQ(modes[1].support, 100U);
}

// What it is there for: outlier removal of all normals leaves the ground alone.
TEST(MeanShift, SmallStructuresBesideTheGroundAreKept) {
    const auto axes = fourAxes();
    const auto normals = planted(axes, {8000, 40, 40, 0}, 1.5, 20);
    const OutlierRemovalOptions outliers;
    const MeanShiftOptions options;
    const auto bare = paper::removeOutliers(normals, outliers);
    ASSERT_TRUE(paper::needsModes(bare, options));
    EXPECT_LT(paper::axesOf(bare).eigenvalues()[0], 0.02);
    const auto modes = seekModes(normals.directions, options);
    const auto pattern = paper::patternOfModes(normals, modes, options, outliers);
    EXPECT_GT(paper::axesOf(pattern).eigenvalues()[0], 0.1);
    EXPECT_GT(pattern.normals, 6000U);
    EXPECT_EQ(pattern.normals + pattern.removed, 8100U);
    for (std::size_t a = 0; a < 3; ++a)
        EXPECT_GT((pattern.directions.transpose() * axes[a].cast<float>()).maxCoeff(),
                  std::cos(1 * kDeg));
}

TEST(MeanShift, NothingToFind) {
    EXPECT_TRUE(seekModes(Eigen::Matrix3Xf(3, 0), {}).empty());
    paper::SurfaceNormals none;
    none.directions.resize(3, 0);
    none.planarity.resize(0);
    const auto pattern = paper::patternOfModes(none, {}, {}, {});
    EXPECT_EQ(pattern.directions.cols(), 0);
    EXPECT_TRUE(paper::needsModes(pattern, {}));
}
}  // namespace
