#include "odometry/search_speed.h"

#include <gtest/gtest.h>

#include "ring_scan.h"

using namespace delio;
using namespace delio::odometry;

namespace {
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kPeriod_s = 0.1;
const test::Sensor kSensor{16, 900, -15, 15, 0.01};

/** Level ground and trees along the x axis. */
test::Scene avenue(std::uint32_t seed) {
    test::Noise noise(seed);
    test::Scene scene{{{-300, -300, -3}, {300, 300, -1.8}}};
    for (const double side : {-1, 1})
        for (double x = -100; x < 200; x += 9 + 4 * noise.uniform()) {
            const double y = side * (7.5 + 1.5 * noise.uniform()),
                         half = 0.2 + 0.1 * noise.uniform();
            scene.push_back({{x - half, y - half, -1.8}, {x + half, y + half, 6}});
        }
    return scene;
}

/** Where the rear of a vehicle is ahead of the origin after `time_s`. */
test::Scene withVehicle(test::Scene scene, double speed_mps, double time_s) {
    const double x = 12 + speed_mps * time_s;
    scene.push_back({{x, -1, -1.6}, {x + 4, 1, 0}});
    return scene;
}

/** What is found in scans that are taken for those of a sensor that stands. */
template <typename SceneAt>
std::optional<std::vector<MovingScan>> search(const SceneAt& sceneAt, double speed_mps, int scans,
                                              const Vector3d& axis = Vector3d::UnitX()) {
    SpeedSearch search(40, 0.25);
    test::Noise noise;
    for (int i = 0; i < scans; ++i) {
        const double time_s = i * kPeriod_s;
        const Isometry3d pose(Eigen::Translation3d(speed_mps * time_s, 0, 0));
        MovingScan scan;
        scan.cloud.points = test::ringScan(sceneAt(time_s), pose, kSensor, noise).points;
        scan.time_s = time_s;
        const double sign = i % 2 == 0 ? 1 : -1;  // an axis has none
        const auto found = search.add(scan, {sign * axis, 0, Eigen::Matrix3f::Identity()});
        if (found) return found;
    }
    return {};
}

Isometry3d lastPose(const std::vector<MovingScan>& scans) { return scans.back().trajectory.at(0); }

Vector3d velocityOf(const std::vector<MovingScan>& scans) {
    const Isometry3d moved = scans.front().trajectory.at(0).inverse() * lastPose(scans);
    return moved.translation() / (scans.back().time_s - scans.front().time_s);
}

class SpeedSearches : public testing::TestWithParam<double> {};
}  // namespace

TEST_P(SpeedSearches, FindTheSpeedOfScansThatSeemToStand) {
    for (const std::uint32_t seed : {1, 2, 3}) {
        const auto scene = avenue(seed);
        const auto found = search([&](double) { return scene; }, GetParam(), 12,
                                  Vector3d(0.9995, 0.03, 0).normalized());
        ASSERT_TRUE(found) << seed;
        EXPECT_NEAR(velocityOf(*found).x(), GetParam(), 0.5) << seed;
        EXPECT_TRUE(lastPose(*found).isApprox(Isometry3d::Identity())) << "the latest scan moved";
    }
}
INSTANTIATE_TEST_SUITE_P(OfCars, SpeedSearches, testing::Values(-12, 11.3, 20, 33.7));

// A lorry that drives along shows most of the points: it has no more votes than any other
// direction.
TEST(SpeedSearch, FindsTheSpeedBesideALorry) {
    for (const std::uint32_t seed : {1, 2, 3}) {
        const auto at = [&](double time_s) {
            auto scene = avenue(seed);
            const double rear = 20 * time_s - 3;
            scene.push_back({{rear, 2, -1.6}, {rear + 9, 4.5, 1.5}});
            return scene;
        };
        const auto found = search(at, 20, 12);
        ASSERT_TRUE(found) << seed;
        EXPECT_NEAR(velocityOf(*found).x(), 20, 0.5) << seed;
    }
}

// Posts every 2 m lie on each other at 10 and 50 m/s, too.
TEST(SpeedSearch, DoesNotTakeEvenlySpacedPostsForEachOther) {
    std::size_t right = 0;
    for (const std::uint32_t seed : {4, 5, 6}) {
        auto scene = avenue(seed);
        for (const double y : {-4.0, 4.0})
            for (double x = -100; x < 200; x += 2)
                scene.push_back({{x - 0.05, y - 0.05, -1.8}, {x + 0.05, y + 0.05, -1}});
        const auto found = search([&](double) { return scene; }, 30, 24);
        if (!found) continue;
        EXPECT_NEAR(velocityOf(*found).x(), 30, 0.5) << seed;
        ++right;
    }
    EXPECT_GE(right, 1U);
}

TEST(SpeedSearch, FindsNoSpeedOfASensorThatStands) {
    for (const std::uint32_t seed : {1, 2, 3}) {
        const auto scene = avenue(seed);
        EXPECT_FALSE(search([&](double) { return scene; }, 0, 24)) << seed;
    }
}

TEST(SpeedSearch, DoesNotFindTheSpeedOfAVehicle) {
    const auto scene = avenue(4);
    const auto at = [&](double time_s) { return withVehicle(scene, 15, time_s); };
    EXPECT_FALSE(search(at, 0, 16));
}

TEST(SpeedSearch, FindsNoSpeedWhereNothingStandsAboveTheGround) {
    const test::Scene ground{{{-300, -300, -3}, {300, 300, -1.8}}};
    EXPECT_FALSE(search([&](double) { return ground; }, 20, 24));
}

TEST(SpeedSearch, FindsNoSpeedBetweenSmoothRails) {
    const auto rails = test::highway(false);
    EXPECT_FALSE(search([&](double) { return rails; }, 25, 24));
}
