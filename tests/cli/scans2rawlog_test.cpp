// scans2rawlog, and delio-slam on what it reads: the same scans whatever they lie in.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "delio/formats/drive_meta.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::expectFailure;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
using test::operator+;
namespace fs = std::filesystem;

class Scans2Rawlog : public test::DelioSlam {
 protected:
    void SetUp() override { test::writeSequence(sequence_, test::toyScans(kScans)); }

    test::CommandResult convert(const fs::path& input, const Words& more = {}) const {
        return runTool("scans2rawlog", Words{"-i", input, "-o", made_} + more);
    }
    std::string side(const std::string& extension) const {
        return io::sidecarPath(made_, extension);
    }
    /** The same through a pipe. */
    test::CommandResult piped(const fs::path& from, const std::string& command) const {
        return runTool("sh", {"-c", "cat '" + from.string() + "' | " + command});
    }

    const fs::path sequence_ = folder_ / "00", made_ = folder_ / "made.rawlog";
};

TEST_F(Scans2Rawlog, AKittiSequenceAsKitti2RawlogDoes) {
    ASSERT_EQ(runTool("kitti2rawlog", {"-i", sequence_, "-o", rawlog_}).exitCode, 0);
    const auto run = convert(sequence_);
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("reading HDL-64E, 10 Hz, points without times, de-skewed by the "
                           "recorder, 5 scans (KITTI odometry)"),
              std::string::npos)
        << run.err;
    EXPECT_TRUE(readText(made_) == readText(rawlog_));
    for (const char* name : {".calib.txt", ".poses.txt"})
        EXPECT_EQ(readText(side(name)), readText(io::sidecarPath(rawlog_, name)));
    EXPECT_EQ(test::namesIn(side("_Images")), test::namesIn(io::sidecarPath(rawlog_, "_Images")));
    expectFailure(convert(sequence_), 1, {"exists", "--force"});
}

TEST_F(Scans2Rawlog, TheSameTrajectoryWithAndWithoutConverting) {
    ASSERT_EQ(convert(sequence_).exitCode, 0);
    ASSERT_EQ(slamOf(sequence_).exitCode, 0);
    const auto converted = folder_ / "converted";
    ASSERT_EQ(runTool("delio-slam", {"-i", made_, "-o", converted, "--no-map"}).exitCode, 0);
    for (const char* name : {"trajectory_kitti.txt", "trajectory_tum.txt",
                             "trajectory_kitti_cam0.txt", "posegraph.g2o", "config.ini"})
        EXPECT_TRUE(readText(fs::path(out_) / name) == readText(converted / name)) << name;
}

TEST_F(Scans2Rawlog, SomeScansAndTheirRows) {
    const auto run = convert(sequence_, {"--start", "1", "--count", "2", "--every", "2"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(readText(side(".times.txt")), "0.100000000\n0.300000000\n");
    const std::string poses = readText(side(".poses.txt"));
    EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 2);
    io::RawlogReader reader(made_);
    EXPECT_NEAR(reader.next()->stamp_s, 0.1, 1e-7);
    EXPECT_NEAR(reader.next()->stamp_s, 0.3, 1e-7);
    EXPECT_FALSE(reader.next());
    expectFailure(convert(sequence_, {"--every", "0", "--force"}), 2, {"--every"});
    expectFailure(convert(sequence_, {"--start", "9", "--force"}), 1, {"no LiDAR scans"});
}

TEST_F(Scans2Rawlog, RingsAndTimesOfPointsComeAlong) {
    const fs::path clouds = folder_ / "clouds";
    fs::create_directory(clouds);
    for (int scan = 0; scan < 2; ++scan) {
        std::ofstream out(clouds / ("scan" + std::to_string(scan) + ".csv"));
        out << "x,y,z,intensity,time,ring\n";
        for (int i = 0; i < 400; ++i)
            out << 5 + scan << "," << 0.01 * i << ",1,0.5," << 0.1 * i / 400 << "," << i % 16
                << "\n";
    }
    const auto run = convert(clouds, {"--embed"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    io::RawlogReader reader(made_);
    for (int scan = 0; scan < 2; ++scan) {
        const auto read = reader.next();
        ASSERT_TRUE(read);
        ASSERT_EQ(read->rings.size(), 400U);
        EXPECT_EQ(read->rings[17], 1);
        EXPECT_NEAR(read->times_s[200], 0.05, 1e-6);
        EXPECT_EQ(read->points->getPointsBufferRef_x()[3], static_cast<float>(5 + scan));
    }
    const auto info = runTool("rawlog-edit", {"--info", "-i", made_});
    EXPECT_EQ(info.exitCode, 0);
    EXPECT_NE(info.out.find("velodyne /      2"), std::string::npos) << info.out;
}

TEST_F(Scans2Rawlog, FromAPipeAndFromAFileAsStandardInput) {
    writeDrive(kScans, true);
    const std::string tool =
        test::toolPath("scans2rawlog") + " -i - --force -o '" + made_.string() + "'";
    const auto run = piped(rawlog_, tool);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("wrote 5 scans"), std::string::npos) << run.err;
    const auto file = runTool("sh", {"-c", tool + " < '" + rawlog_.string() + "'"});
    EXPECT_EQ(file.exitCode, 0) << file.err;
    EXPECT_NE(file.err.find("wrote 5 scans"), std::string::npos) << file.err;
    const auto slam =
        piped(rawlog_, test::toolPath("delio-slam") + " -i - --no-map -o '" + out_.string() + "'");
    EXPECT_EQ(slam.exitCode, 0) << slam.err;
    expectFailure(runTool("sh", {"-c", tool + " < /dev/null"}), 1, {"standard input is empty"});
    expectFailure(runTool("sh", {"-c", tool + " <&-"}), 1, {"standard input"});
    expectFailure(runTool("delio-slam", {"-i", "-", "-i", rawlog_, "-o", out_}), 2,
                  {"standard input must be the only input"});
}

TEST_F(Scans2Rawlog, WhatCameBeforeAFaultIsKept) {
    writeDrive(kScans, true);
    const std::string bytes = readText(rawlog_);
    writeText(folder_ / "cut.rawlog", bytes.substr(0, 7 * bytes.size() / 10));
    expectFailure(convert(folder_ / "cut.rawlog"), 1, {"cut off", "3 scans before it are in"});
    io::RawlogReader reader(made_);
    std::size_t scans = 0;
    while (reader.next()) ++scans;
    EXPECT_EQ(scans, 3U);
}

TEST_F(Scans2Rawlog, RefusesWhatCannotBe) {
    writeDrive(1, true);
    expectFailure(runTool("scans2rawlog", {"-i", rawlog_, "-o", rawlog_, "--force"}), 1,
                  {"also the input"});
    EXPECT_TRUE(io::RawlogReader(rawlog_).next());
    expectFailure(convert(folder_ / "none"), 1, {"no such file or folder"});
    fs::create_directory(folder_ / "empty");
    expectFailure(convert(folder_ / "empty"), 1, {"no scans"});
    writeText(folder_ / "one.ply", "ply\n");
    expectFailure(convert(folder_ / "one.ply"), 1, {"give the folder"});
    EXPECT_FALSE(fs::exists(made_));
}
}  // namespace
