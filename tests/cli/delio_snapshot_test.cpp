#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "command.h"
#include "delio/map/cloud_files.h"
#include "delio/map/map_builder.h"
#include "delio/map/simplemap.h"
#include "delio/picture/scene.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::runTool;

/** One map in every form that the tool reads. */
class SnapshotTool : public testing::Test {
 protected:
    SnapshotTool() {
        unsetenv("DISPLAY");
        mrpt::maps::CPointsMapXYZI cloud;
        for (int i = 0; i < 300; ++i)
            for (int j = -5; j <= 5; ++j)
                cloud.insertPointRGB(static_cast<float>(std::cos(0.02 * i) * (10 + j)),
                                     static_cast<float>(std::sin(0.02 * i) * (10 + j)),
                                     static_cast<float>(j % 3), static_cast<float>(i % 100) / 100,
                                     0, 0);
        map::MapBuilder builder((map::MapOptions()), "velodyne");
        const std::vector<Eigen::Isometry3d> poses = {test::poseAt(0, 0, 0), test::poseAt(5, 0, 0)};
        for (std::size_t i = 0; i < poses.size(); ++i)
            builder.add(i, poses[i], cloud, test::poseAt(0, 0, 1.7),
                        mrpt::Clock::fromDouble(1316995200.0));
        map::saveSimplemap(builder.build(poses).simplemap, at("map.simplemap"));
        const auto points = map::cloudOf(builder.build(poses).points);
        count_ = points.size();
        map::savePly(map::pointsOf(points), at("map.ply"));
        map::savePcd(map::pointsOf(points), at("map.pcd"));
        picture::saveScene(*picture::mapScene(points, {poses, {}, {}, {}}), at("map.3Dscene"));
    }
    std::string at(const std::string& name) const { return folder_ / name; }

    void expectPicture(const std::string& name, std::size_t width, std::size_t height) const {
        mrpt::img::CImage image;
        ASSERT_TRUE(image.loadFromFile(at(name)));
        EXPECT_EQ(image.getWidth(), width);
        EXPECT_EQ(image.getHeight(), height);
    }

    /** One line on stderr, nothing on stdout, the exit code, and no picture or part of one. */
    void expectRefusal(const std::vector<std::string>& arguments, int exitCode) const {
        const auto result = runTool("delio-snapshot", arguments);
        std::string line;
        for (const auto& word : arguments) line += word + " ";
        EXPECT_EQ(result.exitCode, exitCode) << line << result.err;
        EXPECT_TRUE(test::isOneLine(result.err)) << line << result.err;
        EXPECT_EQ(result.out, "") << line;
        for (const auto& file : std::filesystem::directory_iterator(folder_.path())) {
            const std::string name = file.path().filename().string();
            EXPECT_TRUE(name.find("out") == std::string::npos &&
                        name.find("partial") == std::string::npos)
                << line << "left " << name;
        }
    }

    test::TemporaryFolder folder_;
    std::size_t count_ = 0;
};

TEST_F(SnapshotTool, ShowsEveryKindOfMap) {
    for (const char* name : {"map.simplemap", "map.ply", "map.pcd", "map.3Dscene"}) {
        const std::string picture = std::string(name) + ".png";
        const auto result =
            runTool("delio-snapshot", {"-i", at(name), "-o", at(picture), "--size", "321x200"});
        EXPECT_EQ(result.exitCode, 0) << name << result.err;
        EXPECT_EQ(result.out, "");
        EXPECT_EQ(result.err, "");
        expectPicture(picture, 321, 200);
    }
}

TEST_F(SnapshotTool, EveryOptionChangesThePicture) {
    const auto render = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {"-i",      at("map.ply"), "-o",     at("p.png"),
                                          "--force", "--size",      "200x150"};
        words.insert(words.end(), more.begin(), more.end());
        const auto result = runTool("delio-snapshot", words);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return test::readText(at("p.png"));
    };
    const std::string plain = render({});
    EXPECT_EQ(render({}), plain);
    for (const std::vector<std::string>& option : {std::vector<std::string>{"--azimuth", "-30"},
                                                   {"--elevation", "20"},
                                                   {"--zoom", "8"},
                                                   {"--max-height", "0.5"},
                                                   {"--ortho"},
                                                   {"--point-size", "5"},
                                                   {"--shading", "0"},
                                                   {"--shading", "4"},
                                                   {"--background", "#ff8000"},
                                                   {"--background", "white"},
                                                   {"--colormap", "viridis"},
                                                   {"--color-by", "intensity"},
                                                   {"--colormap", "gray"}})
        EXPECT_NE(render(option), plain) << option[0];
}

TEST_F(SnapshotTool, WhatIsHighIsLeftOutOfEveryKindOfMap) {
    for (const char* name : {"map.simplemap", "map.ply", "map.3Dscene"}) {
        const auto colouredBelow = [&](const std::string& height) {
            const auto result =
                runTool("delio-snapshot",
                        {"-i", at(name), "-o", at("p.png"), "--force", "--size", "300x200",
                         "--ortho", "--point-size", "1", "--max-height", height});
            EXPECT_EQ(result.exitCode, 0) << result.err;
            EXPECT_EQ(result.out + result.err, "");
            mrpt::img::CImage image;
            EXPECT_TRUE(image.loadFromFile(at("p.png")));
            int coloured = 0;
            for (unsigned row = 0; row < 200; ++row)
                for (unsigned column = 0; column < 300; ++column) {
                    const auto* bgr = image.ptr<std::uint8_t>(column, row);
                    const auto [low, high] = std::minmax({bgr[0], bgr[1], bgr[2]});
                    coloured += high - low > 60;
                }
            return coloured;
        };
        const int all = colouredBelow("1000"), low = colouredBelow("1.5");
        EXPECT_GT(low, all / 10) << name;
        EXPECT_LT(low, 0.9 * all) << name;
    }
}

TEST_F(SnapshotTool, MarksMakeTheLegendLarger) {
    // Height of the colour bar in a column of the picture, pixels.
    const auto barAt = [&](unsigned column, const std::string& marks) {
        const auto result =
            runTool("delio-snapshot", {"-i", at("map.ply"), "-o", at("p.png"), "--force", "--size",
                                       "600x400", "--marks", marks, "--background", "white"});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        mrpt::img::CImage image;
        EXPECT_TRUE(image.loadFromFile(at("p.png")));
        int height = 0;
        for (unsigned row = 0; row < 400; ++row) {
            const auto* bgr = image.ptr<std::uint8_t>(column, row);
            height += std::min({bgr[0], bgr[1], bgr[2]}) < 200;
        }
        return height;
    };
    const int usual = barAt(14, "1");
    EXPECT_GT(usual, 60);
    EXPECT_NEAR(barAt(28, "2"), 2 * usual, 30);
}

TEST_F(SnapshotTool, OrbitWritesAsManyPictures) {
    const auto result = runTool("delio-snapshot", {"-i", at("map.3Dscene"), "-o", at("round.png"),
                                                   "--orbit", "3", "--size", "120x90"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    std::set<std::string> pictures;
    for (const char* name : {"round_000.png", "round_001.png", "round_002.png"}) {
        expectPicture(name, 120, 90);
        pictures.insert(test::readText(at(name)));
    }
    EXPECT_EQ(pictures.size(), 3U);
    EXPECT_FALSE(std::filesystem::exists(at("round.png")));
    EXPECT_FALSE(std::filesystem::exists(at("round_003.png")));
    // None of them is overwritten unless that is wanted.
    std::filesystem::remove(at("round_000.png"));
    const auto again = runTool("delio-snapshot", {"-i", at("map.3Dscene"), "-o", at("round.png"),
                                                  "--orbit", "3", "--size", "120x90"});
    test::expectFailure(again, 1, {"round_001.png", "--force"});
    EXPECT_FALSE(std::filesystem::exists(at("round_000.png")));
}

TEST_F(SnapshotTool, ASceneTakesAnotherColourmap) {
    const auto render = [&](const std::string& colormap) {
        const auto result =
            runTool("delio-snapshot", {"-i", at("map.3Dscene"), "-o", at("p.png"), "--force",
                                       "--size", "200x150", "--colormap", colormap});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(result.err, "");
        return test::readText(at("p.png"));
    };
    EXPECT_NE(render("turbo"), render("gray"));
}

TEST_F(SnapshotTool, AFullDiskLeavesNothing) {
    for (const std::size_t bytes : {0, 1024, 20 * 1024}) {
        const auto result = test::runToolOnFullDisk(
            "delio-snapshot", {"-i", at("map.ply"), "-o", at("out.png")}, bytes);
        test::expectFailure(result, 1, {"cannot write", "out.png"});
        for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
            EXPECT_EQ(file.path().filename().string().find("out"), std::string::npos);
    }
}

TEST_F(SnapshotTool, RefusesBadInput) {
    const std::string out = at("out.png");
    expectRefusal({"-i", at("missing.ply"), "-o", out}, 1);
    expectRefusal({"-i", at("missing.3Dscene"), "-o", out}, 1);
    expectRefusal({"-i", at("missing.simplemap"), "-o", out}, 1);
    test::writeText(at("notes.txt"), "hello");
    expectRefusal({"-i", at("notes.txt"), "-o", out}, 1);
    for (const char* kind : {".3Dscene", ".simplemap", ".ply"}) {
        test::writeText(at(std::string("text") + kind), "hello");
        expectRefusal({"-i", at(std::string("text") + kind), "-o", out}, 1);
        const std::string whole = test::readText(at(std::string("map") + kind));
        test::writeText(at(std::string("cut") + kind), whole.substr(0, whole.size() * 2 / 3));
        expectRefusal({"-i", at(std::string("cut") + kind), "-o", out}, 1);
    }
    // One kind of MRPT file under the name of another.
    std::filesystem::copy_file(at("map.simplemap"), at("other.3Dscene"));
    expectRefusal({"-i", at("other.3Dscene"), "-o", out}, 1);
    map::saveSimplemap({}, at("empty.simplemap"));
    expectRefusal({"-i", at("empty.simplemap"), "-o", out}, 1);
    map::savePly({}, at("empty.ply"));
    expectRefusal({"-i", at("empty.ply"), "-o", out}, 1);
    picture::saveScene(mrpt::opengl::COpenGLScene(), at("empty.3Dscene"));
    expectRefusal({"-i", at("empty.3Dscene"), "-o", out}, 1);
    expectRefusal({"-i", at("map.3Dscene"), "-o", out, "--color-by", "intensity"}, 1);
    expectRefusal({"-i", at("map.ply"), "-o", out, "--color-by", "time"}, 1);  // it has none
}

TEST_F(SnapshotTool, RefusesBadOutput) {
    expectRefusal({"-i", at("map.ply"), "-o", at("no/such/out.png")}, 1);
    expectRefusal({"-i", at("map.ply"), "-o", at("out.xyz")}, 1);
    test::writeText(at("there.png"), "precious");
    expectRefusal({"-i", at("map.ply"), "-o", at("there.png")}, 1);
    EXPECT_EQ(test::readText(at("there.png")), "precious");
    EXPECT_EQ(runTool("delio-snapshot",
                      {"-i", at("map.ply"), "-o", at("there.png"), "--force", "--size", "64x64"})
                  .exitCode,
              0);
    expectPicture("there.png", 64, 64);
}

TEST_F(SnapshotTool, RefusesABadCommandLine) {
    const std::string in = at("map.ply"), out = at("out.png");
    expectRefusal({}, 2);
    expectRefusal({"-i", in}, 2);
    for (const char* size :
         {"640", "640x", "x480", "0x480", "640x480x3", "-1x5", "640X480", "99999x10", "0x0",
          "100000x100000", "a", "640x480 ", "99999999999999999999x1"})
        expectRefusal({"-i", in, "-o", out, "--size", size}, 2);
    for (const char* colour : {"red", "#12345", "#12345g", "#1234567", "123456", ""})
        expectRefusal({"-i", in, "-o", out, "--background", colour}, 2);
    for (const char* number : {"abc", "1.5x", "nan", "1000"}) {
        expectRefusal({"-i", in, "-o", out, "--azimuth", number}, 2);
        expectRefusal({"-i", in, "-o", out, "--elevation", number}, 2);
    }
    expectRefusal({"-i", in, "-o", out, "--zoom", "0"}, 2);
    expectRefusal({"-i", in, "-o", out, "--zoom", "-5"}, 2);
    expectRefusal({"-i", in, "-o", out, "--point-size", "0"}, 2);
    for (const char* strength : {"-0.1", "4.1", "strong"})
        expectRefusal({"-i", in, "-o", out, "--shading", strength}, 2);
    for (const char* height : {"0", "-1", "1001", "nan", "high", "2m"})
        expectRefusal({"-i", in, "-o", out, "--max-height", height}, 2);
    expectRefusal({"-i", in, "-o", out, "--colormap", "jet"}, 2);
    for (const char* count : {"0", "-3", "1001", "many"})
        expectRefusal({"-i", in, "-o", out, "--orbit", count}, 2);
    expectRefusal({"-i", in, "-o", out, "--no-such-option"}, 2);
}

TEST_F(SnapshotTool, SaysWhatToInstallWithoutEgl) {
    setenv("__EGL_VENDOR_LIBRARY_DIRS", folder_.path().c_str(), 1);
    expectRefusal({"-i", at("map.ply"), "-o", at("out.png")}, 1);
    const auto result = runTool("delio-snapshot", {"-i", at("map.ply"), "-o", at("out.png")});
    EXPECT_NE(result.err.find("libegl1"), std::string::npos) << result.err;
    unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
}

TEST_F(SnapshotTool, Observations2mapTakesTheSimplemap) {
    if (std::system("command -v observations2map >/dev/null") != 0)
        GTEST_SKIP() << "observations2map (Debian: mrpt-apps) is not installed";
    const std::string settings = (test::profileFolder() / "mrpt/observations2map.ini").string();
    const auto result = runTool("observations2map", {settings, at("map.simplemap"), at("o2m")});
    EXPECT_EQ(result.exitCode, 0) << result.out << result.err;
    std::size_t lines = 0;
    for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
        if (file.path().filename().string().find("o2m_") == 0 &&
            file.path().extension() == ".txt") {
            std::istringstream text(test::readText(file.path()));
            for (std::string line; std::getline(text, line);) ++lines;
        }
    EXPECT_GE(lines, count_)
        << "every point of the map (the same voxel from two scans is two here)";
}
}  // namespace
