#include "paper/normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::filterBilaterally;
using paper::SurfaceNormals;

constexpr double kDeg = M_PI / 180;

/** Ground and a wall that meet along y, with normals that are off by `noise_deg`. */
SurfaceNormals corner(double noise_deg) {
    test::Noise noise;
    constexpr Eigen::Index kEach = 400;
    SurfaceNormals normals;
    normals.directions.resize(3, 2 * kEach);
    normals.points.resize(3, 2 * kEach);
    normals.planarity = Eigen::VectorXf::Constant(2 * kEach, 0.9F);
    for (Eigen::Index i = 0; i < 2 * kEach; ++i) {
        const Eigen::Index column = i % kEach % 20, row = i % kEach / 20;
        const double u = 0.4 * static_cast<double>(column), v = 0.4 * static_cast<double>(row);
        const bool ground = i < kEach;
        normals.points.col(i) << static_cast<float>(ground ? 5 - u : 5), static_cast<float>(v),
            static_cast<float>(ground ? -2 : u - 2);
        const Eigen::Vector3d n = ground ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(-1, 0, 0);
        normals.directions.col(i) =
            (n + noise_deg * kDeg * noise.normals()).normalized().cast<float>();
    }
    return normals;
}

/** Mean angle to the surface's own normal. */
double meanError_deg(const SurfaceNormals& normals) {
    double sum = 0;
    for (Eigen::Index i = 0; i < normals.directions.cols(); ++i) {
        const Eigen::Vector3f n = i < normals.directions.cols() / 2 ? Eigen::Vector3f(0, 0, 1)
                                                                    : Eigen::Vector3f(-1, 0, 0);
        sum += std::asin((n - normals.directions.col(i)).norm() / 2) * 2 / kDeg;
    }
    return sum / static_cast<double>(normals.directions.cols());
}

TEST(BilateralFilter, NoiseIsAveragedAndTheEdgeStays) {
    const auto noisy = corner(3);
    const auto filtered = filterBilaterally(noisy, {});
    EXPECT_LT(meanError_deg(filtered), 0.6 * meanError_deg(noisy));
    EXPECT_EQ(filtered.points, noisy.points);
    EXPECT_EQ(filtered.planarity, noisy.planarity);
    EXPECT_LT((filtered.directions.colwise().norm().array() - 1).abs().maxCoeff(), 1e-5F);
    // Without noise nothing moves, not even beside the edge.
    EXPECT_LT(meanError_deg(filterBilaterally(corner(0), {})), 1e-3);
    // What tells the sides of the edge apart is the angle.
    BilateralFilterOptions blind;
    blind.angle_sigma_deg = 180;
    EXPECT_GT(meanError_deg(filterBilaterally(corner(0), blind)), 1);
}

TEST(BilateralFilter, AgreesWithThePlainestWay) {
    const auto normals = corner(4);
    const BilateralFilterOptions options;
    const auto filtered = filterBilaterally(normals, options);
    for (Eigen::Index i = 0; i < normals.points.cols(); i += 7) {
        std::vector<std::pair<double, Eigen::Index>> near;
        for (Eigen::Index j = 0; j < normals.points.cols(); ++j)
            near.emplace_back((normals.points.col(j) - normals.points.col(i)).norm(), j);
        std::sort(near.begin(), near.end());
        // Equal distances may be told apart either way.
        if (near[options.neighbours + 1].first - near[options.neighbours].first < 1e-6) continue;
        Eigen::Vector3d sum(0, 0, 0);
        for (std::size_t k = 0; k <= options.neighbours; ++k) {
            const auto [d, j] = near[k];
            const double chord = (normals.directions.col(j) - normals.directions.col(i)).norm();
            const double angle = chord / (options.angle_sigma_deg * kDeg);
            sum += std::exp(-d * d / (2 * options.distance_sigma * options.distance_sigma) -
                            angle * angle / 2) *
                   normals.directions.col(j).cast<double>();
        }
        EXPECT_LT((filtered.directions.col(i).cast<double>() - sum.normalized()).norm(), 1e-5);
    }
}

TEST(BilateralFilter, SwitchedOffOrWithoutNormals) {
    const auto normals = corner(3);
    BilateralFilterOptions off;
    off.neighbours = 0;
    EXPECT_EQ(filterBilaterally(normals, off).directions, normals.directions);
    SurfaceNormals none;
    none.directions.resize(3, 0);
    none.points.resize(3, 0);
    EXPECT_EQ(filterBilaterally(none, {}).directions.cols(), 0);
}
}  // namespace
