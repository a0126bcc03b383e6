// delio-slam: rawlogs and scans that are damaged, missing or unusable.
#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <limits>

#include "delio/formats/trajectory.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::csvColumns;
using test::DelioSlam;
using test::Floats;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

TEST_F(DelioSlam, RefusesWhatIsNoRawlog) {
    expectRefused(slam(), 1, {rawlog_, "no such file"});
    expectRefused(slamOf(folder_ / "."), 1, {"no scans"});
    const auto withBytes = [&](const std::string& bytes) {
        writeText(folder_ / "x.rawlog", bytes);
        return slamOf(folder_ / "x.rawlog");
    };
    expectRefused(withBytes(""), 1, {"x.rawlog", "empty"});
    expectRefused(withBytes("not a rawlog at all\n"), 1, {"x.rawlog", "not a rawlog"});
    expectRefused(withBytes("\x89PNG\r\n\x1a\n1234567890123456789012345"), 1, {"not a rawlog"});
    expectRefused(withBytes("\x1f\x8b\x08 no gzip either"), 1, {"not a rawlog"});
    expectRefused(withBytes(std::string(4096, '\0')), 1, {"not a rawlog"});
    expectRefused(withBytes(std::string(4096, '\xff')), 1, {"not a rawlog"});
}

TEST_F(DelioSlam, ACutRawlogIsUsedUpToTheCut) {
    writeDrive(4, true);
    const std::string bytes = readText(rawlog_);
    const std::size_t one = bytes.size() / 4;
    const auto cutAt = [&](std::size_t size) {
        writeText(rawlog_, bytes.substr(0, size));
        return slam({"--force"});
    };
    for (const std::size_t size :
         {one + one / 2, 2 * one + 1000, 3 * one + one / 2, bytes.size() - 1}) {
        const auto run = cutAt(size);
        test::expectFailure(run, 1, {"d.rawlog", "cut off"});
        expectPart(size / one);
    }
    fs::remove_all(out_);
    expectRefused(cutAt(1000), 1, {"d.rawlog", "damaged"});
    // In the middle of the next object's name.
    std::size_t second = bytes.find("CObservationPointCloud", 100);
    ASSERT_NE(second, std::string::npos);
    test::expectFailure(cutAt(second + 5), 1, {"cut off"});
    expectPart(1);
    // Bytes that are not what was written.
    std::string damaged = bytes;
    damaged.replace(second, 5, "XXXXX");
    writeText(rawlog_, damaged);
    test::expectFailure(slam({"--force"}), 1, {"damaged after scan 0"});
    expectPart(1);
}

TEST_F(DelioSlam, ARawlogWithoutScansIsAFailedRun) {
    {
        mrpt::io::CFileOutputStream out(rawlog_.string());
        auto archive = mrpt::serialization::archiveFrom(out);
        for (int i = 0; i < 3; ++i) {
            mrpt::obs::CObservationIMU imu;
            imu.timestamp = mrpt::Clock::fromDouble(1316995200.0 + i);
            mrpt::obs::CObservationOdometry odometry;
            odometry.timestamp = imu.timestamp;
            archive << imu << odometry;
        }
    }
    expectRefused(slam(), 1, {"d.rawlog", "no LiDAR scans"});
    // Cut off before there was any.
    const std::string bytes = readText(rawlog_);
    writeText(rawlog_, bytes.substr(0, bytes.size() - 7));
    const auto run = slam();
    expectRefused(run, 1, {"cut off"});
    EXPECT_EQ(run.err.find("-1"), std::string::npos) << run.err;
}

TEST_F(DelioSlam, MissingExternalFiles) {
    writeDrive(4);
    const fs::path images = folder_ / "d_Images";
    fs::rename(images, folder_ / "elsewhere");
    expectRefused(slam(), 1, {"000000.bin", images, folder_ / "Images", "--images"});
    EXPECT_EQ(slam({"--images", folder_ / "elsewhere"}).exitCode, 0);
    fs::rename(folder_ / "elsewhere", folder_ / "Images");
    EXPECT_EQ(slam({"--force"}).exitCode, 0);
    fs::rename(folder_ / "Images", images);

    fs::remove(images / "000002.bin");
    test::expectFailure(slam({"--force"}), 1, {"scan 2", "000002.bin", "--images"});
    expectPart(2);
    writeText(images / "000002.bin", "no sixteen bytes.");
    test::expectFailure(slam({"--force"}), 1, {"scan 2", "000002.bin", "multiple of 16"});
    expectPart(2);
}

TEST_F(DelioSlam, SensorLabels) {
    {
        mrpt::io::CFileOutputStream out(rawlog_.string());
        auto archive = mrpt::serialization::archiveFrom(out);
        for (int i = 0; i < 3; ++i)
            for (const std::string label : {"front", "rear"}) {
                mrpt::obs::CObservationPointCloud scan;
                auto cloud = mrpt::maps::CSimplePointsMap::Create();
                const auto xyzi = test::toyScan({static_cast<double>(i), 0, 0});
                for (std::size_t k = 0; k + 3 < xyzi.size(); k += 4)
                    cloud->insertPoint(xyzi[k], xyzi[k + 1], xyzi[k + 2]);
                scan.pointcloud = cloud;
                scan.sensorLabel = label;
                scan.timestamp = mrpt::Clock::fromDouble(1316995200.0 + 0.1 * i);
                archive << scan;
            }
    }
    const auto first = slam();
    EXPECT_EQ(first.exitCode, 0) << first.err;
    EXPECT_NE(first.err.find("warning: scans of the sensor 'rear' are ignored"), std::string::npos)
        << first.err;
    EXPECT_NE(first.err.find("unknown sensor model"), std::string::npos) << first.err;
    EXPECT_EQ(summary()["warnings"].size(), 2U);
    EXPECT_EQ(summary()["scans"].as<int>(), 3);
    const auto rear = slam({"--sensor-label", "rear", "--force"});
    EXPECT_EQ(rear.exitCode, 0) << rear.err;
    EXPECT_NE(rear.err.find("'front'"), std::string::npos) << rear.err;
    fs::remove_all(out_);
    const auto wrong = slam({"--sensor-label", "roof"});
    expectRefused(wrong, 1, {"no LiDAR scans", "roof"});
    EXPECT_NE(wrong.err.find("'front'"), std::string::npos) << wrong.err;
}

TEST_F(DelioSlam, AnUnusableScanIsAPredictedRow) {
    auto scans = test::toyScans(6);
    scans[2].clear();
    for (auto& value : scans[4]) value = std::numeric_limits<float>::quiet_NaN();
    const std::size_t last = scans[5].size();
    for (int i = 0; i < 8; ++i) scans[5].push_back(std::numeric_limits<float>::quiet_NaN());
    for (const bool embed : {false, true}) {
        writeDrive(rawlog_, scans, embed);
        const auto run = slam({"--force"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        const auto csv = csvColumns(out_ / "scans.csv");
        EXPECT_EQ(csv.at("predicted"), Words({"0", "0", "1", "0", "1", "0"}));
        EXPECT_EQ(csv.at("reason"), Words({"", "", "no points", "",
                                           "all " + std::to_string(scans[4].size() / 4) +
                                               " points are NaN or at the sensor",
                                           ""}));
        EXPECT_EQ(csv.at("points")[2], "0");
        EXPECT_EQ(csv.at("not_finite")[4], std::to_string(scans[4].size() / 4));
        EXPECT_EQ(csv.at("not_finite")[5], "2");
        EXPECT_EQ(summary()["predicted"].as<int>(), 2);
        EXPECT_TRUE(summary()["complete"].as<bool>());
        EXPECT_NEAR(
            io::readTrajectory(out_ / "trajectory_kitti.txt").poses.back().translation().x(), 5,
            0.5);
    }
    EXPECT_EQ(last % 4, 0U);
}

TEST_F(DelioSlam, TheFirstScansMayBeUnusable) {
    auto scans = test::toyScans(4);
    scans[0].clear();
    scans[1] = Floats(40, 0.0F);
    writeDrive(rawlog_, scans);
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});  // with a map
    EXPECT_EQ(run.exitCode, 0) << run.err;
    // The third is the first to have surfaces: how far it is from the first nobody knows.
    EXPECT_EQ(csvColumns(out_ / "scans.csv")["predicted"], Words({"1", "1", "1", "0"}));
    EXPECT_EQ(csvColumns(out_ / "scans.csv")["reason"][2], "no usable scan before it");
    EXPECT_TRUE(fs::exists(out_ / "map.ply"));
}

TEST_F(DelioSlam, NoUsableScanIsAFailedRun) {
    writeDrive(rawlog_, std::vector<Floats>(3));
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    test::expectFailure(run, 1, {"no scan", "points"});
    expectPart(3);
    EXPECT_EQ(csvColumns(out_ / "scans.csv")["reason"], Words(3, "no points"));
    for (auto& scan : {Floats(400, 0.0F), Floats(400, 1e30F)}) {
        writeDrive(rawlog_, std::vector<Floats>(3, scan));
        test::expectFailure(slam({"--force"}), 1, {"no scan", "points"});
    }
}

TEST_F(DelioSlam, AMalformedMetaIsRefused) {
    writeDrive(1);
    for (const char* text : {"- 1\n", "vertical_corection_deg: 0.205\n", "some words\n",
                             "vertical_correction_deg: much\n", "vertical_correction_deg: 100\n",
                             "epoch_unix_s: .nan\n", "a: [1\n", ""}) {
        writeText(folder_ / "d.meta.yaml", text);
        expectRefused(slam(), 1, {"d.meta.yaml"});
    }
    writeText(folder_ / "d.meta.yaml", "vertical_correction_deg: 0.205\n");
    EXPECT_EQ(slam().exitCode, 0);
    EXPECT_EQ(summary()["vertical_correction_deg"].as<double>(), 0.205);
    EXPECT_EQ(slam({"--force", "--set", "scan.vertical_correction_deg=0.1"}).exitCode, 0);
    EXPECT_EQ(summary()["vertical_correction_deg"].as<double>(), 0.1);
}

TEST_F(DelioSlam, TimesThatDoNotRise) {
    struct Case {
        std::vector<double> times;
        std::size_t used;
        std::string words;
    };
    for (const auto& [times, used, words] :
         {Case{{0, 0.1, 0.1, 0.3, 0.4}, 4, "out of order: ignored: 1 scan (first: scan 2)"},
          Case{{0, 0.1, 0.3, 0.2, 0.4}, 5, "sorted by stamp: 1 scan (first: scan 3)"},
          Case{{10, 10.1, 0.2, 0.3, 0.4},
               5,
               "continued from the previous scan: 1 scan (first: scan 2)"},
          Case{{3, 3, 3, 3, 3}, 5, "continued from the previous scan: 4 scans (first: scan 1)"}}) {
        SCOPED_TRACE(words);
        auto scans = test::toyScans(5);
        if (times[3] < times[2]) std::swap(scans[2], scans[3]);
        writeDrive(rawlog_, scans, false, times);
        const auto run = slam({"--force"});
        EXPECT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
        EXPECT_EQ(run.err.find(words), run.err.rfind(words)) << run.err;
        ASSERT_EQ(summary()["warnings"].size(), 1U);
        EXPECT_NE(summary()["warnings"](0).as<std::string>().find(words), std::string::npos);
        for (const char* name : {"trajectory_tum.txt", "trajectory_kitti.txt"})
            EXPECT_EQ(rows(name), used) << name;
        EXPECT_EQ(rows("scans.csv"), used + 1);
        EXPECT_TRUE(summary().has("metrics"));  // KITTI's truth goes by rows
    }
}

TEST_F(DelioSlam, SaysWhyNoPointIsUsed) {
    auto scans = test::toyScans(3);
    for (auto& scan : scans)
        for (std::size_t i = 0; i < scan.size(); i += 4) scan[i] += 4.6e6F;
    writeDrive(rawlog_, scans);
    test::expectFailure(slam(), 1, {"no scan", "farther than scan.max_range", "4.6e+06 m"});
    EXPECT_NE(csvColumns(out_ / "scans.csv")["reason"][1].find("scan.max_range"),
              std::string::npos);
}
}  // namespace
