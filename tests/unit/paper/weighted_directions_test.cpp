#include "paper/weighted_directions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::WeightedDirections;

constexpr double kSigma = 0.05, kReach = 0.12 * 0.12;  // of the chord; and squared

struct Drawn {
    Eigen::Vector3f direction;
    float weight;
};

/** About the x axis, within the reach and beyond it. */
std::vector<Drawn> drawn(int count) {
    test::Noise noise;
    std::vector<Drawn> all;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d aside = 0.08 * noise.normals();
        all.push_back({(Eigen::Vector3d::UnitX() + aside).normalized().cast<float>(),
                       static_cast<float>(1 + noise.uniform())});
    }
    return all;
}

// Groups are of four: also where some are left over.
TEST(WeightedDirections, SumsAreThoseOfOneByOne) {
    constexpr double kRounding = 1e-5;
    for (const int count : {0, 1, 3, 4, 5, 97, 400}) {
        WeightedDirections directions;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double weights = 0, squares = 0;
        const Eigen::Vector3f middle = Eigen::Vector3f::UnitX();
        for (const auto& one : drawn(count)) {
            directions.add(one.direction, one.weight);
            const double squared = (one.direction - middle).cast<double>().squaredNorm();
            if (squared >= kReach) continue;
            const double weight = one.weight * std::exp(-squared / (2 * kSigma * kSigma));
            sum += weight * one.direction.cast<double>();
            weights += weight;
            squares += weight * squared;
        }
        const auto found = directions.under(middle, kSigma, kReach);
        EXPECT_EQ(directions.size(), static_cast<std::size_t>(count));
        EXPECT_LE((found.directions.cast<double>() - sum).norm(), kRounding * weights) << count;
        EXPECT_NEAR(found.weight, weights, kRounding * weights) << count;
        EXPECT_NEAR(found.squares, squares, kRounding * weights) << count;
    }
}

TEST(WeightedDirections, NothingAtAllIsLeftBeyondTheReach) {
    WeightedDirections directions;
    const Eigen::Vector3f direction = Eigen::Vector3f::UnitX();
    directions.add(direction, 1);
    const auto weightFrom = [&](double chord) {
        const Eigen::Vector3f aside =
            direction + static_cast<float>(chord) * Eigen::Vector3f::UnitY();
        return directions.under(aside, kSigma, kReach).weight;
    };
    EXPECT_GT(weightFrom(0.1199), 0.05F);
    EXPECT_EQ(weightFrom(0.1201), 0);
    EXPECT_EQ(weightFrom(2), 0);
    directions.clear();
    EXPECT_EQ(directions.size(), 0U);
    EXPECT_EQ(weightFrom(0), 0);
}
}  // namespace
