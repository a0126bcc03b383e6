#include "delio/map/occupancy.h"

#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <set>

#include "delio/core/error.h"
#include "point_support.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::maps::COccupancyGridMap2D;
using test::pointAt;
using test::poseAt;
using Cell = std::pair<int, int>;

constexpr double kStep = 0.1;

/** The middle of a cell, somewhere beside the origin. */
double middle(int cell) { return (cell + 0.5) * kStep - 7.3; }

/** A place of 20 m by 10 m with a wall on it, a car of which only the roof was seen, a hole in the
 *  ground that nobody looked into, and a sign above a street; and what a grid of it has to be. */
struct Place {
    explicit Place(double slope) : slope_(slope) {
        for (int x = 0; x < 200; ++x)
            for (int y = 0; y < 100; ++y) {
                const bool hole = x >= 140 && x < 180 && y >= 10 && y < 40;
                const bool car = x >= 30 && x < 70 && y >= 70 && y < 88;
                if (!hole && !car) {
                    add(x, y, 0);
                    ground.insert({x, y});
                }
                if (car) {
                    add(x, y, 1.5);
                    occupied.insert({x, y});
                }
                if (y == 50 && x >= 80 && x < 120) {
                    for (double z = 0.1; z < 3; z += 0.25) add(x, y, z);
                    occupied.insert({x, y});
                }
                if (y == 20 && x >= 80 && x < 120) add(x, y, 4);
            }
    }
    void add(int x, int y, double height) {
        points.push_back(pointAt(middle(x), middle(y), slope_ * middle(x) + height));
    }
    /** By definition. */
    double freeAt(int x, int y) const {
        if (occupied.count({x, y})) return 0.02;
        for (int dx = -3; dx <= 3; ++dx)
            for (int dy = -3; dy <= 3; ++dy)
                if (ground.count({x + dx, y + dy})) return 0.98;
        return 0.5;
    }

    double slope_;
    map::MapPoints points;
    std::set<Cell> ground, occupied;
};

TEST(Occupancy, IsWhatItsDefinitionSays) {
    for (const double slope : {0.0, 0.08, -0.2}) {
        const Place place(slope);
        const auto grid = map::occupancyGrid(place.points, {});
        ASSERT_EQ(grid.getSizeX(), 200U);
        ASSERT_EQ(grid.getSizeY(), 100U);
        EXPECT_NEAR(grid.getXMin(), -7.3, 1e-5);
        EXPECT_NEAR(grid.getYMin(), -7.3, 1e-5);
        int wrong = 0;
        for (int x = 0; x < 200; ++x)
            for (int y = 0; y < 100; ++y) {
                if (std::abs(double{grid.getCell(x, y)} - place.freeAt(x, y)) < 0.02) continue;
                if (++wrong < 20)
                    ADD_FAILURE() << "slope " << slope << ", cell " << x << " " << y << ": "
                                  << grid.getCell(x, y) << " not " << place.freeAt(x, y);
            }
        EXPECT_EQ(wrong, 0);
    }
}

TEST(Occupancy, WhatIsHigherThanTheVehicleIsNotInItsWay) {
    map::MapPoints points;
    for (int x = 0; x < 100; ++x)
        for (int y = 0; y < 100; ++y) points.push_back(pointAt(middle(x), middle(y), 0));
    for (int x = 40; x < 60; ++x) points.push_back(pointAt(middle(x), middle(50), 2.5));
    map::OccupancyOptions options;
    EXPECT_GT(map::occupancyGrid(points, {}, options).getCell(50, 50), 0.9);
    options.height_m = 3;
    EXPECT_LT(map::occupancyGrid(points, {}, options).getCell(50, 50), 0.1);
}

TEST(Occupancy, WhatTheVehicleDroveOverIsFree) {
    map::MapPoints points;
    for (int x = 0; x < 300; ++x)
        for (const double z : {0.0, 1.0}) points.push_back(pointAt(middle(x), middle(50), z));
    // Across the row of things, along y = 50 but for a gap of more than 10 m, and out of the map.
    const std::vector<std::vector<Eigen::Isometry3d>> ways = {
        {poseAt(middle(20), middle(45), 0), poseAt(middle(20), middle(55), 0)},
        {poseAt(middle(100), middle(50), 0), poseAt(middle(220), middle(50), 0)},
        {poseAt(middle(310), middle(50), 0)},
        {}};
    const auto grid = map::occupancyGrid(points, ways);
    const auto at = [&](int x, int y) {
        return grid.getPos(static_cast<float>(middle(x)), static_cast<float>(middle(y)));
    };
    for (const int x : {20, 16, 24, 100, 104, 220, 310}) EXPECT_GT(at(x, 50), 0.9) << x;
    for (const int x : {10, 30, 94, 160, 230}) EXPECT_LT(at(x, 50), 0.1) << x;
    EXPECT_GT(at(20, 47), 0.9);
    EXPECT_NEAR(at(120, 56), 0.5, 0.02);
}

TEST(Occupancy, OddMapsMakeGridsToo) {
    EXPECT_THROW(map::occupancyGrid({}, {}), Error);
    EXPECT_EQ(map::occupancyGrid({pointAt(3, 4, 5)}, {}).getSizeX(), 1U);
    // A bridge, a step, a point far below the ground, and the top of a tree away from all.
    map::MapPoints points = {pointAt(10, 5, -30), pointAt(30, 0, 5), pointAt(30.5, 0, 5)};
    for (int x = 0; x < 200; ++x)
        for (int y = 0; y < 100; ++y) {
            points.push_back(pointAt(middle(x), middle(y), x < 100 ? 0 : 3));
            if (y > 40 && y < 60) points.push_back(pointAt(middle(x), middle(y), 6));
        }
    const auto grid = map::occupancyGrid(points, {});
    EXPECT_GT(grid.getCell(20, 50), 0.9);   // under the bridge
    EXPECT_GT(grid.getCell(90, 20), 0.9);   // up to the step
    EXPECT_GT(grid.getCell(170, 20), 0.9);  // above it
    EXPECT_NEAR(grid.getPos(30, 0), 0.5, 0.02);
    map::OccupancyOptions coarse;
    coarse.resolution_m = 5;
    EXPECT_GT(map::occupancyGrid(points, {}, coarse).getSizeX(), 3U);
}

TEST(Occupancy, TooManyCellsAreAnError) {
    try {
        map::occupancyGrid({pointAt(0, 0, 0), pointAt(10000, 5000, 0)}, {});
        ADD_FAILURE();
    } catch (const Error& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find("100001 x 50001"), std::string::npos) << text;
    }
    EXPECT_THROW(map::occupancyGrid({pointAt(-1e30, 0, 0), pointAt(1e30, 1e30, 0)}, {}), Error);
}

TEST(Occupancy, MrptsOwnReaderGetsTheSameCells) {
    const test::TemporaryFolder folder;
    const auto grid = map::occupancyGrid(Place(0.1).points, {});
    map::saveGridmap(grid, folder / "a.gridmap");
    mrpt::io::CFileGZInputStream in((folder / "a.gridmap").string());
    COccupancyGridMap2D loaded;
    mrpt::serialization::archiveFrom(in) >> loaded;
    EXPECT_EQ(loaded.getRawMap(), grid.getRawMap());
    EXPECT_EQ(loaded.getSizeX(), grid.getSizeX());
    EXPECT_EQ(loaded.getXMin(), grid.getXMin());
    EXPECT_EQ(loaded.getYMin(), grid.getYMin());
    EXPECT_EQ(loaded.getResolution(), grid.getResolution());
}

TEST(Occupancy, MapServerGetsAnImageWithItsFirstRowOnTop) {
    const test::TemporaryFolder folder;
    const auto grid = map::occupancyGrid(Place(0).points, {});
    map::saveMapServer(grid, folder / "a \"map\".yaml");
    const auto yaml = mrpt::containers::yaml::FromFile(folder / "a \"map\".yaml");
    EXPECT_EQ(yaml["image"].as<std::string>(), "a \"map\".pgm");
    EXPECT_EQ(yaml["resolution"].as<double>(), 0.1);
    EXPECT_NEAR(yaml["origin"](0).as<double>(), -7.3, 1e-5);
    EXPECT_NEAR(yaml["origin"](1).as<double>(), -7.3, 1e-5);
    EXPECT_EQ(yaml["origin"](2).as<double>(), 0);
    EXPECT_EQ(yaml["negate"].as<int>(), 0);
    EXPECT_EQ(yaml["occupied_thresh"].as<double>(), 0.65);
    EXPECT_EQ(yaml["free_thresh"].as<double>(), 0.196);
    EXPECT_EQ(yaml["mode"].as<std::string>(), "trinary");
    const std::string image = test::readText(folder / "a \"map\".pgm");
    const std::string header = "P5\n200 100\n255\n";
    ASSERT_EQ(image.substr(0, header.size()), header);
    ASSERT_EQ(image.size(), header.size() + std::size_t{200} * 100);
    for (int x = 0; x < 200; ++x)
        for (int y = 0; y < 100; ++y) {
            const auto at = header.size() + static_cast<std::size_t>((99 - y) * 200 + x);
            const float free = grid.getCell(x, y);
            ASSERT_EQ(static_cast<unsigned char>(image[at]), free > 0.9F   ? 254
                                                             : free < 0.1F ? 0
                                                                           : 205);
        }
}

TEST(Occupancy, MapServerGetsBothFilesOrNone) {
    const test::TemporaryFolder folder;
    const auto grid = map::occupancyGrid(Place(0).points, {});
    std::filesystem::create_directory(folder / "a.pgm");
    EXPECT_THROW(map::saveMapServer(grid, folder / "a.yaml"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.yaml"));
    std::filesystem::create_directory(folder / "b.yaml");
    EXPECT_THROW(map::saveMapServer(grid, folder / "b.yaml"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "b.pgm"));
    EXPECT_THROW(map::saveMapServer(grid, folder / "no/such/c.yaml"), Error);
}

/** A sensor at the origin, 1 m above the ground, of which only that about it was seen; walls at 10
 * m, ahead and behind; a box in the way; a high wall to the left. */
struct Hall {
    Hall() {
        for (double x = -2; x <= 2; x += 0.1)
            for (double y = -2; y <= 2; y += 0.1) points.push_back(pointAt(x, y, 0));
        for (double y = -3; y <= 3; y += 0.05)
            for (double z = 0.4; z < 2.6; z += 0.2) {
                points.push_back(pointAt(10, y, z));
                points.push_back(pointAt(-10, y, z));
                points.back().time_s = 7;  // seen when nobody knows where the sensor was
            }
        for (double z = 0.2; z < 1.3; z += 0.1) points.push_back(pointAt(5, 1, z));
        for (double x = -3; x <= 3; x += 0.1) points.push_back(pointAt(x, 10, 9));
        sensor.poses = {poseAt(0, 0, 1), poseAt(100, 0, 1)};
        sensor.stamps_s = {0, 1};
    }
    map::MapPoints points;
    io::Trajectory sensor;
};

TEST(Occupancy, WhatALineOfSightPassesIsFree) {
    const Hall hall;
    const auto blind = map::occupancyGrid(hall.points, {}),
               grid = map::occupancyGrid(hall.points, {}, {}, hall.sensor);
    const auto at = [](const COccupancyGridMap2D& of, double x, double y) {
        return of.getPos(static_cast<float>(x), static_cast<float>(y));
    };
    for (double x = 2.6; x < 9.8; x += 0.1) {
        EXPECT_NEAR(at(blind, x, 0.05), 0.5, 0.02) << x;
        EXPECT_GT(at(grid, x, 0.05), 0.9) << x;
        EXPECT_NEAR(at(grid, -x, 0.05), 0.5, 0.02) << x;
    }
    for (double y = -2.95; y < 3; y += 0.1) EXPECT_LT(at(grid, 10.05, y), 0.1) << y;
    EXPECT_LT(at(grid, 5.05, 1.05), 0.1);          // the box: lines of sight pass above it
    EXPECT_NEAR(at(grid, 5.05, 6.05), 0.5, 0.02);  // beside all lines of sight
    EXPECT_NEAR(at(grid, 0.05, 6.05), 0.5, 0.02);  // below those to the high wall
    EXPECT_NEAR(at(grid, 10.05, 4.05), 0.5, 0.02);
}
}  // namespace
