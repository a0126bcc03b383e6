#include "traffic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "scene_support.h"

namespace {
using namespace delio::synth;

/** A street, or another road. */
struct Way {
    explicit Way(std::uint64_t seed = 4) : Way(Road(urbanPath(seed, 900), seed), 600, seed) {}
    Way(Road given, std::size_t scans, std::uint64_t seed)
        : road(std::move(given)), drive(road, scans, seed) {}
    Road road;
    Drive drive;
};

/** Seen from above: centre, half axes. */
struct Outline {
    Eigen::Vector2d centre, ahead, left;
};

Outline outline(const Eigen::Isometry3d& pose, const Eigen::AlignedBox3d& box) {
    const Eigen::Vector3d half = box.sizes() / 2, centre = pose * Eigen::Vector3d(box.center());
    const Eigen::Matrix3d axes = pose.linear() * half.asDiagonal();
    return {centre.head<2>(), axes.block<2, 1>(0, 0), axes.block<2, 1>(0, 1)};
}

/** Two rectangles are apart if one of their four directions separates them. */
bool collide(const Outline& a, const Outline& b) {
    const std::vector<Eigen::Vector2d> axes = {a.ahead, a.left, b.ahead, b.left};
    for (const auto& axis : axes) {
        const double reach = std::abs(axis.dot(a.ahead)) + std::abs(axis.dot(a.left)) +
                             std::abs(axis.dot(b.ahead)) + std::abs(axis.dot(b.left));
        if (std::abs(axis.dot(a.centre - b.centre)) > reach) return false;
    }
    return true;
}

double distanceTo(const Eigen::Isometry3d& pose, const Eigen::AlignedBox3d& box,
                  const Eigen::Vector3d& from) {
    return box.exteriorDistance(pose.inverse() * from);
}

using SceneAndSeed = std::tuple<std::string, std::uint64_t>;
class SynthTrafficOf : public testing::TestWithParam<SceneAndSeed> {};
INSTANTIATE_TEST_SUITE_P(Synth, SynthTrafficOf,
                         testing::Combine(testing::ValuesIn(sceneNames()),
                                          testing::Values(1, 2, 3, 4)));

TEST_P(SynthTrafficOf, NobodyCollidesOnALongDrive) {
    const auto [name, seed] = GetParam();
    const auto scene = delio::test::sceneOf(name, seed, 900);
    Way way(scene->road(), 900, seed);
    const Traffic traffic(way.road, way.drive, 30, seed);
    ASSERT_EQ(traffic.size(), 30U);
    const Eigen::Vector3d half = way.drive.carrier().isVehicle ? Eigen::Vector3d(2.3, 0.9, 1.5)
                                                               : Eigen::Vector3d(0.35, 0.3, 1.5);
    const Eigen::AlignedBox3d own(-half, half);
    for (std::size_t scan = 0; scan < way.drive.scans(); scan += 3) {
        const double t = kScanPeriod_s * static_cast<double>(scan);
        std::vector<Outline> outlines = {outline(way.drive.lidarPose(scan), own)};
        for (std::size_t m = 0; m < traffic.size(); ++m)
            outlines.push_back(outline(traffic.pose(m, t), traffic.looks(m).box));
        for (std::size_t a = 0; a < outlines.size(); ++a)
            for (std::size_t b = a + 1; b < outlines.size(); ++b)
                EXPECT_FALSE(collide(outlines[a], outlines[b]))
                    << "scan " << scan << ": " << a << " and " << b;
    }
}

TEST(SynthTraffic, ACompanionStaysFourToTenMetresAway) {
    const Way way;
    const Traffic traffic(way.road, way.drive, 1, 4);
    ASSERT_TRUE(traffic.accompanies(0));
    for (std::size_t scan = 0; scan < way.drive.scans(); ++scan) {
        const double t = kScanPeriod_s * static_cast<double>(scan);
        const Eigen::Vector3d sensor = way.drive.lidarPose(scan).translation();
        const auto pose = traffic.pose(0, t);
        const double near = distanceTo(pose, traffic.looks(0).box, sensor);
        EXPECT_GT(near, 4) << "scan " << scan;
        EXPECT_LT((pose.translation() - sensor).norm(), 10) << "scan " << scan;
    }
}

TEST(SynthTraffic, AllKindsTakePartBothWaysAndStayAround) {
    const Way way;
    const Traffic traffic(way.road, way.drive, 24, 4);
    std::array<int, 3> kinds{};
    int passing = 0;
    for (std::size_t m = 0; m < traffic.size(); ++m) {
        ++kinds[static_cast<std::size_t>(traffic.kind(m))];
        const Eigen::Vector3d along = traffic.pose(m, 20).linear().col(0);
        const double yaw = way.road.path().at(way.drive.stationAt(20) + traffic.ahead(m, 20)).yaw;
        const bool against = along.head<2>().dot(Eigen::Vector2d(cos(yaw), sin(yaw))) < 0;
        passing += against ? 1 : 0;
        for (double t = 0; t < 60; t += 0.5)
            EXPECT_LE(std::abs(traffic.ahead(m, t)), traffic.reach());
    }
    EXPECT_GE(kinds[0], 8);
    EXPECT_GE(kinds[1], 2);
    EXPECT_GE(kinds[2], 2);
    EXPECT_GE(passing, 6);
    EXPECT_LE(passing, 16);
}

TEST(SynthTraffic, MovesSmoothlyOnTheGround) {
    const Way way;
    const Traffic traffic(way.road, way.drive, 24, 4);
    for (std::size_t m = 0; m < traffic.size(); ++m) {
        for (double t = 0; t < 60; t += 0.7) {
            const auto pose = traffic.pose(m, t), next = traffic.pose(m, t + 0.1);
            if (std::abs(traffic.ahead(m, t)) > traffic.reach() - 5) continue;  // it may recur
            const Eigen::Vector3d step = pose.inverse() * next.translation();
            EXPECT_GT(step.x(), -1e-6) << "member " << m << " backs up at " << t;
            EXPECT_LT(step.x(), 2);
            EXPECT_LT(std::abs(step.y()), 0.15);
            EXPECT_LT(std::abs(step.z()), 0.02);
        }
        EXPECT_NEAR(traffic.looks(m).box.min().z(), 0, 1e-6);  // wheels and feet touch the ground
        EXPECT_LE(traffic.looks(m).box.sizes().x(), longest_m(traffic.kind(m)) + 1e-6);
        EXPECT_LE(traffic.looks(m).box.sizes().y(), widest_m(traffic.kind(m)) + 1e-6);
    }
}

TEST(SynthTraffic, WhereNoCarsDrivePeopleWalk) {
    for (const std::string name : {"indoor", "forest"}) {
        const auto scene = delio::test::sceneOf(name, 3, 300);
        const Drive drive(scene->road(), 300, 3);
        const Traffic traffic(scene->road(), drive, 6, 3);
        ASSERT_EQ(traffic.size(), 6U);
        for (std::size_t m = 0; m < traffic.size(); ++m) {
            EXPECT_EQ(traffic.kind(m), RoadUserKind::kPedestrian);
            EXPECT_EQ(traffic.accompanies(m), name == "indoor");
            for (double t = 1; t < 29; t += 0.5) {
                const Eigen::Vector3d feet = traffic.pose(m, t).translation();
                EXPECT_NEAR(feet.z(), scene->road().height(feet.head<2>()), 0.06) << name;
                if (name != "indoor") continue;
                EXPECT_GT(std::abs(traffic.ahead(m, t)), 2.4);
                EXPECT_LT(std::abs(traffic.ahead(m, t)), 9);
            }
        }
    }
}

TEST(SynthTraffic, MoreThanTheLanesHoldAreLeftOut) {
    const Way way;
    const Traffic crowd(way.road, way.drive, 2000, 4);
    EXPECT_GT(crowd.size(), 100U);
    EXPECT_LT(crowd.size(), 2000U);
    EXPECT_EQ(Traffic(way.road, way.drive, 0, 4).size(), 0U);
}
}  // namespace
