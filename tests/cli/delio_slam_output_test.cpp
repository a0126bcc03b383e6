// delio-slam: folders that cannot be written, or only in part.
#include <gtest/gtest.h>

#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using mrpt::containers::yaml;
using test::DelioSlam;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

TEST_F(DelioSlam, OutputFolder) {
    writeDrive(1);
    fs::create_directories(out_);
    EXPECT_EQ(slam().exitCode, 0);  // an empty one is as good as none
    const auto before = readText(out_ / "summary.yaml");
    test::expectFailure(slam(), 1, {out_, "--force"});
    EXPECT_EQ(readText(out_ / "summary.yaml"), before);
    const auto into = [&](const std::string& out) {
        return runTool("delio-slam", {"-i", rawlog_, "-o", out, "--no-map", "--force"});
    };
    EXPECT_EQ(into(folder_ / "a" / "b" / "").exitCode, 0);
    EXPECT_TRUE(fs::exists(folder_ / "a" / "b" / "summary.yaml"));
    test::expectFailure(into(rawlog_), 1, {"not a folder"});
    test::expectFailure(into("/proc/out"), 1, {"/proc/out"});
    test::expectFailure(into(rawlog_ / "out"), 1, {"d.rawlog/out"});
    test::expectFailure(into(""), 1, {"cannot create the folder"});
}

// The limit is reached by keyframes or submaps that are put aside, by files of the map, or by small
// files.
TEST_F(DelioSlam, AFullDiskLeavesNothingHalfWritten) {
    writeDrive();
    for (const std::size_t kilobytes : {1, 8, 100, 300, 600, 1000}) {
        fs::remove_all(out_);
        const auto run = test::runToolOnFullDisk(
            "delio-slam", {"-i", rawlog_, "-o", out_, "--set", "map.voxel_size=0"},
            kilobytes * 1024);
        EXPECT_EQ(run.exitCode, 1) << kilobytes << run.err;
        const bool spool = run.err.find("cannot put") != std::string::npos;
        EXPECT_TRUE(spool || run.err.find("cannot write") != std::string::npos) << run.err;
        if (!fs::exists(out_)) continue;
        for (const auto& file : fs::directory_iterator(out_))
            EXPECT_EQ(file.path().filename().string().find("partial"), std::string::npos)
                << kilobytes << file.path();
    }
}

TEST_F(DelioSlam, WithoutARendererAllButThePicturesIsThere) {
    writeDrive(3);
    const test::TemporaryFolder nothing;
    setenv("__EGL_VENDOR_LIBRARY_DIRS", nothing.path().c_str(), 1);
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    unsetenv("__EGL_VENDOR_LIBRARY_DIRS");
    test::expectFailure(run, 1, {"libegl1"});
    for (const char* name : {"map.ply", "map.3Dscene", "map.simplemap", "summary.yaml"})
        EXPECT_TRUE(fs::exists(out_ / name)) << name;
    EXPECT_FALSE(fs::exists(out_ / "map.png"));
    const auto summary = yaml::FromFile(out_ / "summary.yaml");
    EXPECT_TRUE(summary["complete"].as<bool>());
    EXPECT_NE(summary["fault"].as<std::string>().find("libegl1"), std::string::npos);
}

// A folder with a summary is whole: new results are put in their places together, or not at all.
TEST_F(DelioSlam, WhatCannotBeWrittenLeavesWhatWasThere) {
    writeDrive(3);
    for (const char* name : {"posegraph.g2o", "scans.csv", "config.ini", "trajectory_kitti.txt"}) {
        fs::remove_all(out_);
        ASSERT_EQ(slam().exitCode, 0);
        EXPECT_TRUE(summary()["complete"].as<bool>());
        // A directory with something in it: neither removed nor replaced.
        fs::remove(out_ / name);
        fs::create_directory(out_ / name);
        writeText(out_ / name / "mine.txt", "mine");
        const auto before = readText(out_ / "summary.yaml");
        test::expectFailure(slam({"--force"}), 1, {name});
        EXPECT_EQ(readText(out_ / "summary.yaml"), before) << name;
        EXPECT_TRUE(fs::exists(out_ / name / "mine.txt")) << name;
        expectNothingPartial();
    }
}
}  // namespace
