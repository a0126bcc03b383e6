#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "drive.h"
#include "floor_plan.h"
#include "indoor_scene.h"
#include "random.h"
#include "ray_caster.h"
#include "scene_support.h"
#include "tile_window.h"

namespace {
using namespace delio;
using namespace delio::synth;
using Eigen::Vector2d;
using Eigen::Vector3d;

Eigen::AlignedBox2d grown(const Eigen::AlignedBox2d& box, double by) {
    return Eigen::AlignedBox2d(box.min().array() - by, box.max().array() + by);
}

/** In which space of the plan a place is; none: in a door. */
const Space* spaceAt(const FloorPlan& plan, const Vector2d& place) {
    for (const auto& space : plan.spaces())
        if (space.area.contains(place)) return &space;
    return nullptr;
}

TEST(SynthFloorPlan, RoomsAndCorridorsAreAsLargeAsTheyAreSaidToBe) {
    std::set<SpaceKind> kinds;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const FloorPlan plan(seed, 1000);
        for (const auto& space : plan.spaces()) {
            kinds.insert(space.kind);
            const Vector2d size = space.area.sizes();
            EXPECT_GE(space.height_m, 2.5);
            EXPECT_LE(space.height_m, 3.5);
            if (space.kind == SpaceKind::kRoom) {
                EXPECT_GE(size.minCoeff(), 4);
                EXPECT_LE(size.maxCoeff(), 12);
            } else {
                EXPECT_GE(size.minCoeff(), 1.8);
                EXPECT_LE(size.minCoeff(), 2.6);
            }
        }
    }
    EXPECT_EQ(kinds.size(), 4U);
}

TEST(SynthFloorPlan, NoTwoSpacesMeet) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const FloorPlan plan(seed, 1000);
        const auto& spaces = plan.spaces();
        for (std::size_t i = 0; i < spaces.size(); ++i)
            for (std::size_t k = i + 1; k < spaces.size(); ++k) {
                const double apart = spaces[i].area.exteriorDistance(spaces[k].area);
                ASSERT_GE(apart, FloorPlan::kWall_m - 1e-9) << "seed " << seed << ": " << i << k;
            }
    }
}

TEST(SynthFloorPlan, TheWalkGoesThroughTheMiddleOfDoors) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const FloorPlan plan(seed, 500);
        const Path path = plan.path();
        for (double s = path.begin() + 0.01; s < path.end() - 0.5; s += 0.05) {
            const Station at = path.at(s);
            const Vector2d place(at.x, at.y);
            if (const Space* space = spaceAt(plan, place)) {
                // Not along a wall, but where it leads through one.
                const bool inside = grown(space->area, -0.6).contains(place);
                const double across = std::abs(std::sin(2 * at.yaw));
                EXPECT_TRUE(inside || across < 1e-6) << "seed " << seed << ", s " << s;
                continue;
            }
            double nearest = 1;
            for (const auto& space : plan.spaces())
                for (const auto& door : space.doors) {
                    const bool alongY = door.wall == Wall::kWest || door.wall == Wall::kEast;
                    if (grown(space.area, 0.3).contains(place))
                        nearest = std::min(
                            nearest, std::abs(door.middle_m - (alongY ? place.y() : place.x())));
                }
            EXPECT_LT(nearest, 1e-6) << "seed " << seed << ", s " << s;
        }
    }
}

TEST(SynthIndoor, AMinuteOfWalkingLeadsThroughRoomsCorridorsAndALevel) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const IndoorScene scene(seed, 100);
        const Drive drive(scene.road(), 600, seed);
        EXPECT_NEAR(drive.station(60), 6, 1.2);
        EXPECT_NEAR(drive.station(599), 60, 9);
        std::set<const Space*> rooms, corridors;
        double lowest = 1e3, highest = -1e3;
        for (std::size_t i = 0; i < 600; ++i) {
            const Vector3d place = drive.lidarPose(i).translation();
            EXPECT_NEAR(place.z() - scene.road().height(place.head<2>()), 1.35, 0.1);
            lowest = std::min(lowest, place.z());
            highest = std::max(highest, place.z());
            if (const Space* space = spaceAt(scene.plan(), place.head<2>()))
                (space->kind == SpaceKind::kRoom ? rooms : corridors).insert(space);
        }
        EXPECT_GE(rooms.size(), 3U) << seed;
        EXPECT_GE(corridors.size(), 2U) << seed;
        EXPECT_GT(highest - lowest, 0.75) << seed;
    }
}

TEST(SynthIndoor, TheWayIsFreeAndWallsAreAllAround) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const IndoorScene scene(seed, 110);
        const Drive drive(scene.road(), 900, seed);
        RayCaster caster;
        TileWindow window(scene, caster);
        Random random{seed};
        std::size_t near = 0;
        for (std::size_t i = 0; i + 4 < 900; i += 4) {
            window.moveTo(drive.station(i));
            const auto pose = drive.lidarPose(i);
            const Vector3d way = drive.lidarPose(i + 4).translation() - pose.translation();
            std::vector<Hit> hits;
            for (const double side : {-0.35, 0.0, 0.35})
                for (const double below : {-1.0, -0.5, 0.0, 0.4}) {
                    const Vector3d from = pose * Vector3d(0, side, below);
                    caster.cast(from, {way.normalized()}, way.norm(), hits);
                    ASSERT_EQ(hits[0].range, 0) << "seed " << seed << ", scan " << i;
                }
            std::vector<Vector3d> all;
            all.reserve(200);
            for (int k = 0; k < 200; ++k)
                all.push_back(
                    Vector3d(random.normal(), random.normal(), random.normal()).normalized());
            caster.cast(pose.translation(), all, 100, hits);
            for (const auto& hit : hits) {
                ASSERT_GT(hit.range, 0.4) << "seed " << seed << ", scan " << i;
                near += hit.range < 1 ? 1 : 0;
            }
        }
        EXPECT_GT(near, 225U * 2);  // what a sensor with a reach from 0.9 m would miss
    }
}

TEST(SynthIndoor, RoomsAreFurnished) {
    const IndoorScene scene(1, 100);
    std::size_t triangles = 0;
    for (int index = -1; index < 3; ++index) triangles += scene.tile(index).triangles().size();
    EXPECT_GT(triangles, 8000U);
}
}  // namespace
