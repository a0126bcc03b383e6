#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdio>
#include <cstdlib>
#include <set>

#include "delio/map/cloud_files.h"
#include "delio/map/map_builder.h"
#include "delio/map/map_point.h"
#include "delio/map/simplemap.h"
#include "delio/picture/scene.h"
#include "delio/run/run_folder.h"
#include "delio_slam_fixture.h"
#include "poses.h"

namespace {
using namespace delio;
using test::DelioSlam;
using test::runTool;
namespace fs = std::filesystem;
using test::Words;
using test::operator+;

/** A street of 40 m by 20 m with a wall beside it, as a map of which everything is known. */
map::MapPoints street() {
    map::MapPoints points;
    const auto add = [&](double x, double y, double z, const Eigen::Vector3f& normal) {
        map::MapPoint point;
        point.position = Eigen::Vector3d(x, y, z).cast<float>();
        point.normal = normal;
        point.intensity = static_cast<float>(points.size() % 100) / 100;
        point.time_s = static_cast<float>(points.size()) / 100;
        point.residual_m = static_cast<float>(points.size() % 7) / 100;
        point.observations = static_cast<std::uint16_t>(points.size() % 9 + 1);
        points.push_back(point);
    };
    for (int i = -100; i < 100; ++i) {
        for (int j = -50; j < 50; ++j) add(0.2 * i, 0.2 * j, -1.7, {0, 0, 1});
        for (int k = 0; k < 15; ++k) add(0.2 * i, 8.1, -1.7 + 0.2 * k, {0, -1, 0});
    }
    return points;
}

/** A map in every form that the tool reads. */
class MapTool : public testing::Test {
 protected:
    MapTool() {
        unsetenv("DISPLAY");
        map::savePly(points_, at("map.ply"));
        map::savePcd(points_, at("map.pcd"));
        fs::create_directory(at("run"));
        map::savePly(points_, at("run/map.ply"));
        io::writeKitti({ways_, {}}, at("run/trajectory_kitti.txt"));
        map::MapOptions everything;
        everything.voxelSize_m = everything.minRange_m = 0;
        map::MapBuilder builder(everything, "velodyne");
        builder.add(0, ways_[0], map::cloudOf(points_), test::poseAt(0, 0, 0),
                    mrpt::Clock::fromDouble(1316995200.0));
        map::saveSimplemap(builder.build(ways_).simplemap, at("map.simplemap"));
        before_ = names();
    }
    std::string at(const std::string& name) const { return folder_ / name; }

    std::set<std::string> names() const {
        std::set<std::string> all;
        for (const auto& file : fs::directory_iterator(folder_.path()))
            all.insert(file.path().filename().string());
        return all;
    }

    void expectSuccess(const Words& arguments) const {
        const auto result = runTool("delio-map", arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(result.out + result.err, "");
    }

    /** One line that holds `word`, the exit code, and no file that was not there before. */
    void expectRefusal(const Words& arguments, int exitCode, const std::string& word = "") const {
        const auto before = names();
        const auto result = runTool("delio-map", arguments);
        std::string line;
        for (const auto& each : arguments) line += each + " ";
        EXPECT_EQ(result.exitCode, exitCode) << line << result.err;
        EXPECT_TRUE(test::isOneLine(result.err)) << line << result.err;
        EXPECT_NE(result.err.find(word), std::string::npos) << line << result.err;
        EXPECT_EQ(result.out, "") << line;
        EXPECT_EQ(names(), before) << line;
    }

    test::TemporaryFolder folder_;
    const map::MapPoints points_ = street();
    const std::vector<Eigen::Isometry3d> ways_ = {test::poseAt(0, 0, 0), test::poseAt(6, 0, 0)};
    std::set<std::string> before_;
};

void expectSame(const map::MapPoints& a, const map::MapPoints& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].position, b[i].position) << i;
        ASSERT_EQ(a[i].normal, b[i].normal) << i;
        ASSERT_EQ(a[i].time_s, b[i].time_s) << i;
        ASSERT_EQ(a[i].observations, b[i].observations) << i;
    }
}

TEST_F(MapTool, ReadsEveryKindOfMapAndWritesEveryKindOfFile) {
    for (const std::string input : {"map.ply", "map.pcd", "map.simplemap", "run"})
        for (const std::string kind : {".ply", ".pcd", ".3Dscene", ".gridmap", ".yaml"}) {
            const std::string out = at("out-of-" + input + kind);
            expectSuccess({"-i", at(input), "-o", out});
            EXPECT_GT(fs::file_size(out), 50U) << out;
            EXPECT_FALSE(fs::exists(out + ".frame.yaml"));
            if (kind == ".yaml") {
                EXPECT_TRUE(fs::exists(at("out-of-" + input + ".pgm")));
            }
        }
    for (const std::string input : {"map.ply", "map.pcd", "run"}) {
        expectSame(map::loadPly(at("out-of-" + input + ".ply")), points_);
        expectSame(map::loadPcd(at("out-of-" + input + ".pcd")), points_);
    }
    EXPECT_EQ(map::loadPly(at("out-of-map.simplemap.ply")).size(), points_.size());
    EXPECT_TRUE(picture::loadScene(at("out-of-run.3Dscene"))->getByName("trajectory"));
    EXPECT_FALSE(picture::loadScene(at("out-of-map.ply.3Dscene"))->getByName("trajectory"));
}

TEST_F(DelioSlam, MapOfItsRunIsRead) {
    writeDrive(12);
    const auto run = test::runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const std::string stored = out_ / run::RunFolder::kStoredMap;
    const auto points = [&](const Words& more) {
        const std::string out = folder_ / "points.ply";
        const auto result = runTool("delio-map", Words{"-o", out, "--force"} + more);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return map::loadPly(out).size();
    };
    EXPECT_EQ(points({"-i", out_}), map::loadPly(out_ / run::RunFolder::kPly).size());
    const std::size_t all = points({"-i", stored}), few = points({"-i", stored, "--spacing", "2"});
    EXPECT_GT(all, 1000U);
    EXPECT_GT(few, 50U);
    EXPECT_LT(few, all / 2);
    for (const auto& input : {out_.string(), stored}) {
        const std::string grid = folder_ / "way.gridmap";
        const auto result = runTool("delio-map", {"-i", input, "-o", grid, "--force"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        mrpt::io::CFileGZInputStream in(grid);
        mrpt::maps::COccupancyGridMap2D loaded;
        mrpt::serialization::archiveFrom(in) >> loaded;
        for (const float x : {0.0F, 2.5F, 10.0F}) EXPECT_GT(loaded.getPos(x, 0), 0.9) << x;
    }
}

TEST_F(MapTool, TakesAPartOfTheMap) {
    expectSuccess({"-i", at("map.ply"), "-o", at("part.ply"), "--crop", "0,-5,-2,10,5,0"});
    auto expected = points_;
    map::crop(expected, {Eigen::Vector3d(0, -5, -2), Eigen::Vector3d(10, 5, 0)});
    EXPECT_GT(expected.size(), 1000U);
    expectSame(map::loadPly(at("part.ply")), expected);
    expectSuccess({"-i", at("map.ply"), "-o", at("thin.pcd"), "--spacing", "1"});
    expected = points_;
    map::thinOut(expected, 1);
    EXPECT_LT(expected.size(), points_.size() / 10);
    expectSame(map::loadPcd(at("thin.pcd")), expected);
}

TEST_F(MapTool, LeavesOutWhatIsHigh) {
    expectSuccess({"-i", at("map.ply"), "-o", at("low.ply"), "--max-height", "1.5"});
    auto expected = points_;
    map::MapPoints dynamic;
    map::cutAbove(expected, dynamic, 1.5);
    EXPECT_EQ(expected.size(), points_.size() - 200 * 7);  // the upper half of the wall
    expectSame(map::loadPly(at("low.ply")), expected);
}

TEST_F(MapTool, APageKnowsNorth) {
    const auto northOf = [&](const Words& more) {
        expectSuccess(Words{"-i", at("run"), "-o", at("page.html"), "--force"} + more);
        const auto page = test::readText(at("page.html"));
        double x = 0, y = 0;
        const auto found = page.find("\n\"north\":[");
        if (found != page.npos) {
            EXPECT_EQ(std::sscanf(page.c_str() + found, "\n\"north\":[%lf,%lf]", &x, &y), 2);
        }
        return Eigen::Vector2d(x, y);
    };
    EXPECT_EQ(northOf({}), Eigen::Vector2d::Zero());
    const Words place = {"--georeference", "49,8,100,30"};
    EXPECT_LT((northOf(place) - Eigen::Vector2d(0, 1)).norm(), 1e-3);
    // A degree west of the middle of its zone, north leans to the east of the grid.
    const double lean = M_PI / 180 * std::sin(49 * M_PI / 180);
    const Eigen::Vector2d inGrid = northOf(place + Words{"--frame", "utm"});
    EXPECT_LT((inGrid - Eigen::Vector2d(lean, 1)).norm(), 1.1e-3);
}

TEST_F(MapTool, ColoursAreThoseAskedFor) {
    const auto write = [&](const Words& more) {
        expectSuccess(Words{"-i", at("map.ply"), "-o", at("out.ply"), "--force"} + more);
        return test::readText(at("out.ply"));
    };
    std::set<std::string> files = {write({}), write({"--colormap", "viridis"})};
    for (const char* value : {"intensity", "time", "normal", "residual", "observations"})
        files.insert(write({"--color-by", value}));
    EXPECT_EQ(files.size(), 7U);
    EXPECT_EQ(write({"--color-by", "height", "--colormap", "turbo"}), write({}));
    for (const char* value : {"time", "normal", "residual", "observations"})
        expectRefusal({"-i", at("map.simplemap"), "-o", at("out.pcd"), "--color-by", value}, 1,
                      value);
}

TEST_F(MapTool, AGridIsTheSameForMrptAndForRos) {
    const Words options = {"--resolution", "0.2", "--height", "1.5"};
    expectSuccess(Words{"-i", at("run"), "-o", at("grid.gridmap")} + options);
    expectSuccess(Words{"-i", at("run"), "-o", at("grid.yaml")} + options);
    mrpt::io::CFileGZInputStream in(at("grid.gridmap"));
    mrpt::maps::COccupancyGridMap2D grid;
    mrpt::serialization::archiveFrom(in) >> grid;
    EXPECT_NEAR(grid.getResolution(), 0.2, 1e-6);
    EXPECT_GT(grid.getPos(3, 0), 0.9);
    EXPECT_LT(grid.getPos(3, 8.1F), 0.1);
    const auto yaml = mrpt::containers::yaml::FromFile(at("grid.yaml"));
    EXPECT_NEAR(yaml["origin"](0).as<double>(), grid.getXMin(), 1e-5);
    EXPECT_NEAR(yaml["resolution"].as<double>(), 0.2, 1e-6);
    EXPECT_EQ(yaml["image"].as<std::string>(), "grid.pgm");
    const std::string image = test::readText(at("grid.pgm"));
    EXPECT_EQ(image.substr(image.size() - grid.getSizeX(), 1), "\xfe");  // the street's corner
}

TEST_F(MapTool, StandsLevelOnTheGround) {
    // The run as if the sensor had been tilted: its map is, too.
    const auto tilt = test::poseAtDeg(0, 0, 0, 0, 10, -5);
    auto points = points_;
    map::move(points, tilt);
    map::savePly(points, at("run/map.ply"));
    expectSuccess({"-i", at("run"), "-o", at("level.ply"), "--frame", "ground"});
    const auto level = map::loadPly(at("level.ply"));
    for (std::size_t i = 0; i < level.size(); i += 100) {
        EXPECT_NEAR(level[i].position.z(), points_[i].position.z() + 1.7, 0.01) << i;
        EXPECT_NEAR(level[i].normal.z(), points_[i].normal.z(), 1e-3) << i;
    }
    const auto yaml = mrpt::containers::yaml::FromFile(at("level.ply.frame.yaml"));
    Eigen::Matrix4d out;
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) out(r, c) = yaml["transformation"](r)(c).as<double>();
    for (std::size_t i = 0; i < level.size(); i += 1000)
        EXPECT_LT((out * points[i].position.cast<double>().homogeneous() -
                   level[i].position.cast<double>().homogeneous())
                      .norm(),
                  1e-4);
    // The box is one of the levelled map.
    expectSuccess({"-i", at("run"), "-o", at("floor.ply"), "--frame", "ground", "--crop",
                   "-100,-100,-0.1,100,100,0.1"});
    EXPECT_NEAR(static_cast<double>(map::loadPly(at("floor.ply")).size()), 200 * 101, 1);
    // A frame's file goes with the map that it was of.
    expectSuccess({"-i", at("run"), "-o", at("level.ply"), "--force"});
    EXPECT_FALSE(fs::exists(at("level.ply.frame.yaml")));
}

TEST_F(MapTool, StandsOnTheEarth) {
    expectSuccess(
        {"-i", at("run"), "-o", at("earth.pcd"), "--georeference", "49.011,8.4228,112.8,90"});
    const auto earth = map::loadPcd(at("earth.pcd"));
    // It headed east: the map's axes are those of the earth there.
    for (std::size_t i = 0; i < earth.size(); i += 100)
        EXPECT_LT((earth[i].position - points_[i].position).norm(), 0.01) << i;
    const auto yaml = mrpt::containers::yaml::FromFile(at("earth.pcd.frame.yaml"));
    EXPECT_EQ(yaml["origin"]["latitude_deg"].as<double>(), 49.011);
    EXPECT_EQ(yaml["origin"]["altitude_m"].as<double>(), 112.8);
    const double x = yaml["ecef_from_enu"](0)(3).as<double>();
    const double y = yaml["ecef_from_enu"](1)(3).as<double>();
    EXPECT_NEAR(std::atan2(y, x) * 180 / M_PI, 8.4228, 1e-9);
    expectSuccess({"-i", at("run"), "-o", at("north.pcd"), "--georeference", "-33.9,151.2,5,0"});
    const auto north = map::loadPcd(at("north.pcd"));
    EXPECT_NEAR(north[0].position.x(), -points_[0].position.y(), 0.01);
    EXPECT_NEAR(north[0].position.y(), points_[0].position.x(), 0.01);
}

TEST_F(MapTool, RefusesBadInput) {
    for (const char* name : {"missing.ply", "missing.pcd", "missing.simplemap", "missing.delio",
                             "missing", "missing.xyz"})
        expectRefusal({"-i", at(name), "-o", at("out.ply")}, 1, name);
    fs::create_directory(at("empty"));
    expectRefusal({"-i", at("empty"), "-o", at("out.ply")}, 1, "map.ply");
    test::writeText(at("notes.txt"), "hello");
    expectRefusal({"-i", at("notes.txt"), "-o", at("out.ply")}, 1, ".pcd");
    for (const char* kind : {".ply", ".pcd", ".simplemap"}) {
        const std::string whole = test::readText(at(std::string("map") + kind));
        test::writeText(at(std::string("cut") + kind), whole.substr(0, whole.size() / 2));
        expectRefusal({"-i", at(std::string("cut") + kind), "-o", at("out.ply")}, 1, "cut");
    }
    map::savePly({}, at("nothing.ply"));
    expectRefusal({"-i", at("nothing.ply"), "-o", at("out.pcd")}, 1, "nothing.ply");
    test::writeText(at("packed.pcd"),
                    "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\n"
                    "DATA binary_compressed\n");
    expectRefusal({"-i", at("packed.pcd"), "-o", at("out.ply")}, 1, "compressed");
}

TEST_F(MapTool, RefusesWhatCannotBeDone) {
    const std::string in = at("map.ply");
    for (const char* name : {"out.xyz", "out", "out.simplemap", "out.PLY"}) {
        expectRefusal({"-i", in, "-o", at(name)}, 1,
                      ".ply, .pcd, .las, .3Dscene, .html, .gridmap, .yaml");
    }
    expectRefusal({"-i", in, "-o", at("no/such/out.ply")}, 1, "no/such");
    expectRefusal({"-i", in, "-o", at("out.ply"), "--crop", "900,900,0,901,901,1"}, 1, "--crop");
    expectRefusal({"-i", in, "-o", at("out.gridmap"), "--resolution", "0.001"}, 1, "cells");
    auto wall = points_;
    map::crop(wall, {Eigen::Vector3d(-100, 8, -1), Eigen::Vector3d(100, 9, 100)});
    map::savePly(wall, at("wall.ply"));
    expectRefusal({"-i", at("wall.ply"), "-o", at("out.ply"), "--frame", "ground"}, 1, "ground");
    expectRefusal({"-i", at("wall.ply"), "-o", at("out.ply"), "--georeference", "1,2,3,4"}, 1,
                  "ground");
    for (const auto& [name, bytes] :
         {std::pair("out.ply", 0), std::pair("out.ply", 1024), std::pair("out.pcd", 1024),
          std::pair("out.3Dscene", 1024), std::pair("out.gridmap", 0), std::pair("out.yaml", 0),
          std::pair("out.yaml", 1024)}) {
        const auto result =
            test::runToolOnFullDisk("delio-map", {"-i", in, "-o", at(name), "--frame", "ground"},
                                    static_cast<std::size_t>(bytes));
        test::expectFailure(result, 1, {"cannot write", "out."});
        for (const auto& left : names()) EXPECT_NE(left.substr(0, 3), "out") << left;
    }
}

TEST_F(MapTool, OverwritesOnlyWhatItMay) {
    const std::string in = at("map.ply");
    expectRefusal({"-i", in, "-o", in, "--force"}, 1, "choose another output");
    expectRefusal({"-i", at("run"), "-o", at("run/map.ply"), "--force"}, 1,
                  "choose another output");
    fs::create_symlink(in, at("link.ply"));
    expectRefusal({"-i", in, "-o", at("link.ply"), "--force"}, 1, "choose another output");
    for (const auto& [there, out] :
         {std::pair("a.pcd", "a.pcd"), std::pair("b.yaml", "b.yaml"), std::pair("c.pgm", "c.yaml"),
          std::pair("d.pcd.frame.yaml", "d.pcd")}) {
        test::writeText(at(there), "precious");
        expectRefusal({"-i", in, "-o", at(out)}, 1, "--force");
        EXPECT_EQ(test::readText(at(there)), "precious");
        expectSuccess({"-i", in, "-o", at(out), "--force"});
        EXPECT_TRUE(fs::exists(at(out)));
    }
    EXPECT_NE(test::readText(at("c.pgm")), "precious");
    expectSame(map::loadPly(in), points_);
}

TEST_F(MapTool, RefusesABadCommandLine) {
    const Words in = {"-i", at("map.ply"), "-o", at("out.ply")};
    const Words grid = {"-i", at("map.ply"), "-o", at("out.yaml")};
    expectRefusal({}, 2);
    expectRefusal({"-i", at("map.ply")}, 2);
    for (const char* box :
         {"", "1,2,3", "0,0,0,1,1", "0,0,0,1,1,1,1", "0,0,0,1,1,nan", "0,0,0,1,1,inf",
          "0,0,0,1,1,x", "0,0,0,1,1,", "0 0 0 1 1 1", "1,0,0,0,1,1", "0,0,5,1,1,4"})
        expectRefusal(in + Words{"--crop", box}, 2, "crop");
    for (const char* place : {"", "1,2,3", "91,0,0,0", "-90.1,0,0,0", "0,181,0,0", "0,0,0,361",
                              "nan,0,0,0", "0,0,inf,0", "a,b,c,d", "1,2,3,4,5"})
        expectRefusal(in + Words{"--georeference", place}, 2, "georeference");
    for (const char* number : {"-1", "nan", "inf", "many", "1x", "1001"}) {
        expectRefusal(in + Words{"--spacing", number}, 2, "spacing");
        expectRefusal(in + Words{"--max-height", number}, 2, "max-height");
        expectRefusal(grid + Words{"--resolution", number}, 2, "resolution");
        expectRefusal(grid + Words{"--height", number}, 2, "height");
    }
    expectRefusal(grid + Words{"--resolution", "0"}, 2);
    expectRefusal(grid + Words{"--height", "0.2"}, 2, "0.3");
    expectRefusal(in + Words{"--color-by", "taste"}, 2);
    expectRefusal(in + Words{"--colormap", "jet"}, 2);
    expectRefusal(in + Words{"--frame", "moon"}, 2);
    expectRefusal(in + Words{"--frame", "map", "--georeference", "1,2,3,4"}, 2);
    // What would have no effect.
    expectRefusal(in + Words{"--resolution", "0.1"}, 2, "grid");
    expectRefusal(in + Words{"--height", "1"}, 2, "grid");
    expectRefusal(grid + Words{"--max-height", "1"}, 2, "grid");
    expectRefusal(grid + Words{"--color-by", "time"}, 2, "grid");
    expectRefusal(grid + Words{"--colormap", "gray"}, 2, "grid");
    expectRefusal(in + Words{"--no-such-option"}, 2);
}
}  // namespace
