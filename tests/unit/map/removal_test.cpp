#include <gtest/gtest.h>

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <tbb/global_control.h>

#include <chrono>
#include <set>
#include <tuple>

#include "delio/map/map_builder.h"
#include "delio/map/simplemap.h"
#include "map/visibility_votes.h"
#include "map/voxel_set.h"
#include "map_support.h"
#include "poses.h"
#include "ring_scan.h"

namespace {
using namespace delio;
using map::BuiltMap;
using map::MapBuilder;
using map::MapOptions;
using map::MapPoints;
using test::Block;
using test::poseAt;

const test::Sensor kSensor{48, 900, -24, 4, 0.02};

/** A street along x with houses, kerbs and thin posts; the ground is at -1.8. */
test::Scene street() {
    test::Scene scene = {{{-200, -50, -3}, {500, 50, -1.8}},
                         {{-100, 5.5, -1.8}, {200, 7, -1.65}},
                         {{-100, -8, -1.8}, {200, -6.5, -1.65}}};
    for (int i = -6; i < 14; ++i) {
        scene.push_back({{12.0 * i, 9, -1.8}, {12.0 * i + 8, 20, 4.0 + i % 4}});
        scene.push_back({{12.0 * i + 4, -22, -1.8}, {12.0 * i + 11, -10, 5}});
        scene.push_back({{12.0 * i + 2, 6, -1.8}, {12.0 * i + 2.1, 6.1, 2}});
    }
    return scene;
}

Block van(double x, double y) { return {{x, y - 1, -1.6}, {x + 5, y + 1, 0.2}}; }

std::size_t countIn(const MapPoints& points, const Block& block, double grown_m = 0.15) {
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.end(), [&](const map::MapPoint& point) {
            const Eigen::Array3d p = point.position.cast<double>().array();
            return (p > block.low.array() - grown_m).all() &&
                   (p < block.high.array() + grown_m).all();
        }));
}

class Removal : public testing::Test {
 protected:
    explicit Removal(const MapOptions& options = {}) : builder_(options), kept_(without(options)) {}

    static MapOptions without(MapOptions options) {
        options.removal.enabled = false;
        return options;
    }

    /** One more scan, interval_ after the one before, into a map with removal and one without.
     *  `told`: the odometry labelled `things` as moving. */
    void look(const Eigen::Isometry3d& pose, const test::Scene& things, bool told = false) {
        test::Scene scene = street();
        scene.insert(scene.end(), things.begin(), things.end());
        const auto seen = ringScan(scene, pose, sensor_, noise_).points;
        mrpt::maps::CSimplePointsMap cloud;
        std::vector<std::uint8_t> moving;
        for (Eigen::Index i = 0; i < seen.cols(); ++i) {
            cloud.insertPoint(seen(0, i), seen(1, i), seen(2, i));
            map::MapPoint point;
            point.position = (pose * seen.col(i).cast<double>()).cast<float>();
            moving.push_back(told && std::any_of(things.begin(), things.end(), [&](const auto& b) {
                                 return countIn({point}, b) > 0;
                             }));
        }
        if (!isLabelled_) moving.clear();
        const auto stamp = test::kStamp + interval_ * static_cast<int>(poses_.size());
        for (auto* builder : {&builder_, &kept_})
            builder->add(poses_.size(), pose, cloud, test::kHere, stamp, moving);
        poses_.push_back(pose);
    }

    MapBuilder builder_, kept_;
    std::vector<Eigen::Isometry3d> poses_;
    test::Noise noise_;
    test::Sensor sensor_ = kSensor;
    std::chrono::milliseconds interval_{500};
    bool isLabelled_ = true;
};

TEST_F(Removal, WhatDroveThroughIsGoneAndWhatStandsStays) {
    for (int i = 0; i < 30; ++i)
        look(poseAt(0.8 * i, 0, 0), {van(0.8 * i + 7, 0), van(40 - 1.5 * i, 3)});
    const BuiltMap clean = builder_.build(poses_), all = kept_.build(poses_);
    // Where they were, above the ground.
    for (const Block& way :
         {Block{{7, -1, -1.5}, {20, 1, 0.2}}, Block{{5, 2, -1.5}, {30, 4, 0.2}}}) {
        ASSERT_GT(countIn(all.points, way), 500U);
        EXPECT_LT(countIn(clean.points, way), 0.02 * double(countIn(all.points, way)));
        EXPECT_GT(countIn(clean.dynamic, way), 0.98 * double(countIn(all.points, way)));
    }
    std::size_t posts = 0, before = 0;
    for (int i = -1; i < 4; ++i) {
        const Block post{{12.0 * i + 2, 6, -1.6}, {12.0 * i + 2.1, 6.1, 2}};
        posts += countIn(clean.points, post);
        before += countIn(all.points, post);
    }
    ASSERT_GT(before, 40U);
    EXPECT_GE(double(posts), 0.9 * double(before));
    const Block kerb{{-20, 5.5, -1.8}, {40, 7, -1.65}}, house{{0, 9, -1.7}, {8, 9.2, 4}};
    EXPECT_GE(double(countIn(clean.points, kerb)), 0.99 * double(countIn(all.points, kerb)));
    EXPECT_GE(double(countIn(clean.points, house)), 0.99 * double(countIn(all.points, house)));
    // The keyframes' clouds are as clean.
    const auto frames = map::pointsOf(map::pointsOf(clean.simplemap));
    const auto framesBefore = map::pointsOf(map::pointsOf(all.simplemap));
    const Block way{{7, -1, -1.5}, {20, 1, 0.2}};
    EXPECT_LT(countIn(frames, way), 0.02 * double(countIn(framesBefore, way)));
}

TEST_F(Removal, ACarThatLeavesItsParkingPlaceGoesWithoutAnybodyMoving) {
    const Block place = van(8, -4), stays = van(16, -4);
    for (int i = 0; i < 12; ++i) look(test::kHere, {place, stays});
    const auto parked = builder_.build(poses_).points;
    for (int i = 0; i < 25; ++i) look(test::kHere, {stays});
    const auto left = builder_.build(poses_).points;
    const Block above{{8, -5, -1.5}, {13, -3, 0.2}};
    ASSERT_GT(countIn(parked, above), 100U);
    EXPECT_LT(countIn(left, above), 0.02 * double(countIn(parked, above)));
    EXPECT_GE(double(countIn(left, stays)), 0.98 * double(countIn(parked, stays)));
}

TEST_F(Removal, SparseTwigsMostlyStay) {
    sensor_ = {16, 900, -15, 15, 0.02};
    test::Noise draw(5);
    const Block bush{{6, 3, -1.6}, {8.4, 5, 0.8}};
    test::Scene twigs;
    for (int i = 0; i < 250; ++i) {
        const Eigen::Vector3d at(7.2 + 1.2 * draw.uniform(), 4 + draw.uniform(),
                                 -0.4 + 1.2 * draw.uniform());
        twigs.push_back({at, at + Eigen::Vector3d::Constant(0.06)});
    }
    for (int i = 0; i < 25; ++i) look(poseAt(0.5 * i, 0, 0), twigs);
    const auto kept = countIn(builder_.build(poses_).points, bush),
               all = countIn(kept_.build(poses_).points, bush);
    ASSERT_GT(all, 200U);
    EXPECT_GE(double(kept), 0.8 * double(all)) << kept << " of " << all;
}

TEST_F(Removal, OneScanAloneIsKept) {
    look(test::kHere, {van(8, 0)});
    const BuiltMap clean = builder_.build(poses_), all = kept_.build(poses_);
    EXPECT_EQ(clean.points.size(), all.points.size());
    EXPECT_TRUE(clean.dynamic.empty());
}

TEST_F(Removal, WhatTheOdometryToldIsOneVoice) {
    // Once told to move, and seen to stand ten times.
    for (int i = 0; i < 10; ++i) look(test::kHere, {van(8, 0)}, i == 3);
    const Block side = van(8, 0);
    const auto count = countIn(builder_.build(poses_).points, side);
    EXPECT_GT(count, 100U);
    EXPECT_EQ(countIn(builder_.build(poses_).dynamic, side), 0U);
    // Told every time, and never looked through: that it moves is all that is known.
    MapBuilder other((MapOptions()));
    std::swap(builder_, other);
    poses_.clear();
    for (int i = 0; i < 3; ++i) look(test::kHere, {van(8, 0)}, true);
    EXPECT_LT(double(countIn(builder_.build(poses_).points, {{8, -1, -1.4}, {13, 1, 0.2}})),
              0.02 * double(count));
}

/** It hides the places that it leaves from all later scans. */
TEST_F(Removal, AVanThatFollowsIsGone) {
    interval_ = std::chrono::milliseconds(100);
    for (int i = 0; i < 16; ++i) look(poseAt(1.0 * i, 0, 0), {van(1.0 * i - 13, 0)});
    const Block first{{-13, -1, -1.4}, {-8, 1, 0.2}};
    const auto all = countIn(kept_.build(poses_).points, first);
    ASSERT_GT(all, 50U);
    EXPECT_LT(double(countIn(builder_.build(poses_).points, first)), 0.1 * double(all));
}

/** Nobody looks at its last places after it left them. */
TEST_F(Removal, AVanAheadIsGoneInScansWithoutLabels) {
    interval_ = std::chrono::milliseconds(100);
    isLabelled_ = false;
    for (int i = 0; i < 16; ++i) look(poseAt(1.0 * i, 0, 0), {van(1.0 * i + 8, 0)});
    const Block last{{23, -1, -1.4}, {28, 1, 0.2}};
    const auto all = countIn(kept_.build(poses_).points, last);
    ASSERT_GT(all, 50U);
    EXPECT_LT(double(countIn(builder_.build(poses_).points, last)), 0.1 * double(all));
}

TEST_F(Removal, TheSameForAnyNumberOfThreads) {
    for (int i = 0; i < 8; ++i) look(poseAt(0.8 * i, 0, 0), {van(0.8 * i + 7, 0)});
    const auto build = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return builder_.build(poses_);
    };
    const BuiltMap one = build(1), two = build(2);
    ASSERT_EQ(one.points.size(), two.points.size());
    EXPECT_EQ(one.dynamic.size(), two.dynamic.size());
    for (std::size_t i = 0; i < one.points.size(); ++i) {
        EXPECT_EQ(one.points[i].position, two.points[i].position);
        EXPECT_EQ(one.points[i].normal, two.points[i].normal);
        EXPECT_EQ(one.points[i].observations, two.points[i].observations);
    }
}

TEST_F(Removal, PointsKnowTheirTimeTheirSurfaceAndHowOftenTheyWereSeen) {
    for (int i = 0; i < 8; ++i) look(test::kHere, {});
    const auto points = builder_.build(poses_).points;
    std::size_t ground = 0;
    for (const auto& point : points) {
        if (point.position.head<2>().norm() > 6 || point.position.z() > -1.7F) continue;
        ++ground;
        if (point.normal.norm() == 0) continue;
        EXPECT_GT(point.normal.z(), 0.9F);  // on the sensor's side
        EXPECT_LT(point.residual_m, 0.06F);
        EXPECT_GE(point.observations, 1);
        EXPECT_LE(point.observations, 8);
        EXPECT_LE(point.time_s, 3.5F);
    }
    EXPECT_GT(ground, 500U);
}

/** Where a first point lies in its voxel is kept in 1/256; just below a border it rounds to all of
 *  them, which is one too many for a byte. */
TEST(VisibilityVotes, APointJustBelowABorderOfItsVoxelStaysThere) {
    map::RemovalOptions options;
    options.voxelSize_m = 4;
    map::VisibilityVotes votes(options);
    const Eigen::Vector3d point(-1e-17, 10, 0.1);
    votes.hit(point, false, 0);
    // A wall 20 m ahead, of which only a part is seen: what stands 10 m ahead was looked through,
    // what stands 4 m beside was not.
    Eigen::Matrix3Xf wall(3, 81 * 81);
    for (Eigen::Index i = 0; i < wall.cols(); ++i)
        wall.col(i) = Eigen::Vector3f(0.05F * static_cast<float>(i % 81 - 40), 20,
                                      0.05F * static_cast<float>(i / 81 - 40));
    for (int k = 0; k < 4; ++k)
        votes.look(odometry::RangeImage(wall, options.cell_deg), Eigen::Isometry3d::Identity(), 60);
    votes.decide();
    EXPECT_TRUE(votes.isDynamic(point));
}

TEST(VoxelSet, TakesVoxelsAsBruteForceDoes) {
    constexpr double kSize = 0.7;
    map::VoxelSet voxels(kSize);
    std::set<std::tuple<int, int, int>> taken;
    test::Noise noise;
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d p = 4 * noise.normals();
        const Eigen::Array3i cell = (p / kSize).array().floor().cast<int>();
        const std::tuple<int, int, int> key{cell.x(), cell.y(), cell.z()};
        EXPECT_EQ(voxels.insert(p), taken.insert(key).second) << i;
    }
}

TEST(VoxelSet, WithoutASizeEveryPointHasAVoxelOfItsOwn) {
    map::VoxelSet voxels(0);
    EXPECT_TRUE(voxels.insert({1, 2, 3}));
    EXPECT_TRUE(voxels.insert({1, 2, 3}));
}
}  // namespace
