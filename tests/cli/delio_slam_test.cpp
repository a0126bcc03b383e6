// delio-slam: the files of the contract, the same bytes, and bad inputs.
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "command.h"
#include "delio/io/rawlog_writer.h"
#include "delio/io/trajectory.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using mrpt::containers::yaml;
using test::Floats;
using test::linesOf;
using test::readText;
using test::runTool;
using test::writeText;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr std::size_t kScans = 5;
const char* const kTr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/** A csv as columns by their names. */
std::map<std::string, Words> csvColumns(const fs::path& file) {
    std::vector<Words> rows;
    for (const auto& line : linesOf(readText(file))) {
        rows.emplace_back();
        std::istringstream cells(line + ",");
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    std::map<std::string, Words> columns;
    for (std::size_t c = 0; c < rows[0].size(); ++c)
        for (std::size_t r = 1; r < rows.size(); ++r) {
            EXPECT_EQ(rows[r].size(), rows[0].size()) << "row " << r;
            columns[rows[0][c]].push_back(rows[r].at(c));
        }
    return columns;
}

class DelioSlam : public testing::Test {
 protected:
    /** Scans as a rawlog with all that belongs beside it. */
    void writeDrive(const fs::path& rawlog, const std::vector<Floats>& scans, bool embed = false,
                    std::vector<double> times = {}) const {
        io::RawlogWriter writer(rawlog, "velodyne", embed, true);
        std::string poses, timesText;
        for (std::size_t i = 0; i < scans.size(); ++i) {
            const auto n = static_cast<double>(i);
            if (times.size() <= i) times.push_back(0.1 * n);
            writer.add(times[i], io::kDriveEpoch_s, scans[i]);
            timesText += std::to_string(times[i]) + "\n";
            poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(n) + "\n";  // 1 m a scan
        }
        io::DriveMeta meta;
        meta.source = "synthetic";
        meta.epoch_s = io::kDriveEpoch_s;
        writer.finish(meta, timesText, kTr, poses);
    }
    void writeDrive(std::size_t scans = kScans, bool embed = false) const {
        writeDrive(rawlog_, test::toyScans(scans), embed);
    }

    /** Options that make a run short: few starts of the wide search. */
    static Words quick() {
        return {"--no-map", "--set", "line_registration.search_radius=1", "--set",
                "line_cloud.kept=1"};
    }
    test::CommandResult slam(const Words& more = {}) const { return slamOf(rawlog_, more); }
    test::CommandResult slamOf(const fs::path& input, const Words& more = {}) const {
        return runTool("delio-slam", Words{"-i", input, "-o", out_} + quick() + more);
    }
    /** Nothing came out at all. */
    void expectRefused(const test::CommandResult& run, int exitCode, const Words& words) const {
        test::expectFailure(run, exitCode, words);
        EXPECT_EQ(run.out, "");
        EXPECT_FALSE(fs::exists(out_));
    }
    /** Ended early: what was done is there and consistent, and said to be incomplete. */
    void expectPart(std::size_t scans) const {
        EXPECT_FALSE(summary()["complete"].as<bool>());
        EXPECT_EQ(summary()["scans"].as<int>(), static_cast<int>(scans));
        EXPECT_EQ(rows("trajectory_kitti.txt"), scans);
        EXPECT_EQ(rows("trajectory_tum.txt"), scans);
        EXPECT_EQ(rows("scans.csv"), scans + 1);
        for (const auto& name : test::namesIn(out_))
            EXPECT_EQ(name.find("partial"), std::string::npos) << name;
    }
    yaml summary() const { return yaml::FromFile((out_ / "summary.yaml").string()); }
    std::size_t rows(const std::string& name) const {
        return linesOf(readText(out_ / name)).size();
    }

    test::TemporaryFolder folder_;
    fs::path rawlog_ = folder_ / "d.rawlog";
    fs::path out_ = folder_ / "out";
};

TEST_F(DelioSlam, LeavesTheFilesOfTheContract) {
    writeDrive();
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(test::errorOf(run), "");
    EXPECT_NE(run.out.find("scans"), std::string::npos);
    EXPECT_EQ(test::namesIn(out_),
              Words({"config.ini", "map.3Dscene", "map.ply", "map.png", "map.simplemap",
                     "posegraph.g2o", "posegraph.graph", "scans.csv", "summary.yaml",
                     "trajectory.png", "trajectory_kitti.txt", "trajectory_kitti_cam0.txt",
                     "trajectory_odometry_kitti.txt", "trajectory_tum.txt"}));

    for (const char* name : {"trajectory_kitti.txt", "trajectory_odometry_kitti.txt",
                             "trajectory_kitti_cam0.txt", "trajectory_tum.txt"})
        EXPECT_EQ(rows(name), kScans) << name;
    const auto lidar = io::readTrajectory(out_ / "trajectory_kitti.txt");
    EXPECT_EQ(linesOf(readText(out_ / "trajectory_kitti.txt"))[0], "1 0 0 0 0 1 0 0 0 0 1 0");
    EXPECT_NEAR(lidar.poses.back().x(), kScans - 1, 0.3);
    const auto tum = io::readTrajectory(out_ / "trajectory_tum.txt");
    EXPECT_EQ(tum.stamps_s, io::readTimes(folder_ / "d.times.txt"));
    const auto Tr = io::readCalibration(folder_ / "d.calib.txt").Tr;
    const auto cam0 = io::readTrajectory(out_ / "trajectory_kitti_cam0.txt");
    for (std::size_t i = 0; i < kScans; ++i) {
        EXPECT_LT(lidar.poses[i].distanceEuclidean6D(tum.poses[i]), 1e-12);
        EXPECT_LT(cam0.poses[i].distanceEuclidean6D(Tr + lidar.poses[i] + (-Tr)), 1e-9);
    }
    const auto eval = runTool("delio-eval", {"--ref", out_ / "trajectory_kitti_cam0.txt", "--est",
                                             out_ / "trajectory_kitti.txt", "--calib",
                                             folder_ / "d.calib.txt", "--format", "tsv"});
    ASSERT_EQ(eval.exitCode, 0) << eval.err;
    EXPECT_NE(eval.out.find("\t0.000000000\t0.000000000\t0.000000000\n"), std::string::npos)
        << eval.out;

    const auto csv = csvColumns(out_ / "scans.csv");
    for (const char* column : {"scan", "stamp_s", "points", "normals", "modes", "lines", "matches",
                               "residual_m", "predicted", "reason"})
        ASSERT_TRUE(csv.count(column)) << column;
    EXPECT_EQ(csv.at("scan"), Words({"0", "1", "2", "3", "4"}));
    EXPECT_EQ(csv.at("predicted"), Words(kScans, "0"));
    EXPECT_EQ(csv.at("reason"), Words(kScans, ""));

    const auto summary = this->summary();
    EXPECT_TRUE(summary["complete"].as<bool>());
    EXPECT_EQ(summary["version"].as<std::string>(), "0.1.0");
    EXPECT_EQ(summary["profile"].as<std::string>(), "accurate");
    EXPECT_EQ(summary["scans"].as<int>(), static_cast<int>(kScans));
    EXPECT_EQ(summary["predicted"].as<int>(), 0);
    EXPECT_EQ(summary["vertical_correction_deg"].as<double>(), 0);
    EXPECT_GT(summary["ms_per_scan"].as<double>(), 0);
    EXPECT_GT(summary["peak_rss_mb"].as<double>(), 1);
    EXPECT_EQ(summary["command"].as<std::string>(),
              test::toolPath("delio-slam") + " -i " + rawlog_.string() + " -o " + out_.string());
    EXPECT_TRUE(summary.has("ms_per_scan_of_stages"));
    EXPECT_TRUE(summary["warnings"].isSequence());
    EXPECT_LT(summary["metrics"]["ape_m"].as<double>(), 0.3);
    EXPECT_NEAR(summary["metrics"]["length_m"].as<double>(), kScans - 1, 1e-6);
}

TEST_F(DelioSlam, TheSameBytesForAnyThreadsAndFromItsOwnConfig) {
    writeDrive();
    const auto into = [&](const std::string& name, const Words& more) {
        return runTool("delio-slam", Words{"-i", rawlog_, "-o", folder_ / name} + more);
    };
    const Words options = {"--set", "line_registration.search_radius=1", "--set",
                           "scan.vertical_correction_deg=0.1"};
    ASSERT_EQ(into("one", options + Words{"--threads", "1"}).exitCode, 0);
    ASSERT_EQ(into("two", options + Words{"--threads", "2"}).exitCode, 0);
    ASSERT_EQ(into("fed", {"-c", folder_ / "one" / "config.ini", "--threads", "2"}).exitCode, 0);
    for (const std::string other : {"two", "fed"}) {
        for (const std::string name :
             {"trajectory_kitti.txt", "trajectory_odometry_kitti.txt", "trajectory_kitti_cam0.txt",
              "trajectory_tum.txt", "posegraph.g2o", "posegraph.graph", "config.ini", "map.ply"})
            EXPECT_EQ(readText(folder_ / "one" / name), readText(folder_ / other / name))
                << other << " " << name;
        auto a = csvColumns(folder_ / "one" / "scans.csv");
        auto b = csvColumns(folder_ / other / "scans.csv");
        for (const auto& [column, cells] : a) {
            const bool isTime = column.size() > 3 && column.substr(column.size() - 3) == "_ms";
            if (!isTime) {
                EXPECT_EQ(cells, b[column]) << other << " " << column;
            }
        }
    }
}

TEST_F(DelioSlam, StartCountAndEveryPickScans) {
    writeDrive(6);
    const auto picked = [&](const Words& more) {
        const auto run = slam(Words{"--force"} + more);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return csvColumns(out_ / "scans.csv")["scan"];
    };
    EXPECT_EQ(picked({"--start", "4"}), Words({"4", "5"}));
    EXPECT_EQ(picked({"--start", "1", "--count", "2"}), Words({"1", "2"}));
    EXPECT_EQ(picked({"--every", "2"}), Words({"0", "2", "4"}));
    EXPECT_EQ(picked({"--start", "1", "--every", "3", "--count", "9"}), Words({"1", "4"}));
    EXPECT_EQ(io::readTrajectory(out_ / "trajectory_tum.txt").stamps_s,
              (std::vector<double>{0.1, 0.4}));
    EXPECT_NEAR(summary()["metrics"]["length_m"].as<double>(), 3, 1e-6);  // truth of the same rows
    fs::remove_all(out_);
    expectRefused(slam({"--start", "6"}), 1, {"no LiDAR scans", "--start 6"});
}

TEST_F(DelioSlam, LeavesOutWhatIsNotWanted) {
    writeDrive(3);
    fs::create_directory(out_);
    for (const char* stale : {"map.ply", "map.png", "map.3Dscene", "map.simplemap"})
        writeText(out_ / stale, "of an earlier run");
    writeText(out_ / "mine.txt", "mine");
    const auto run = slam({"--no-graph", "--force"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    for (const char* name : {"map.ply", "map.png", "map.3Dscene", "map.simplemap"})
        EXPECT_FALSE(fs::exists(out_ / name)) << name;
    EXPECT_TRUE(fs::exists(out_ / "trajectory.png"));
    EXPECT_TRUE(fs::exists(out_ / "mine.txt"));
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"),
              readText(out_ / "trajectory_odometry_kitti.txt"));
}

TEST_F(DelioSlam, ABadCommandLineIsExit2) {
    writeDrive(1);
    expectRefused(slam({"--set", "graph.skip_edges=many"}), 2, {"graph.skip_edges", "many"});
    expectRefused(slam({"--set", "graph.skip_egdes=1"}), 2, {"graph.skip_egdes"});
    expectRefused(slam({"--set", "grahp.skip_edges=1"}), 2, {"grahp"});
    expectRefused(slam({"--set", "scan.max_range=nan"}), 2, {"scan.max_range"});
    expectRefused(slam({"--set", "skip_edges=1"}), 2, {"section.key=value"});
    expectRefused(slam({"--profile", "fast"}), 2, {"fast", "paper"});
    expectRefused(slam({"-c", folder_ / "none.ini"}), 2, {"none.ini"});
    expectRefused(slam({"-c", folder_.path()}), 2, {folder_.path()});
    const auto withConfig = [&](const std::string& text) {
        writeText(folder_ / "c.ini", text);
        return slam({"-c", folder_ / "c.ini"});
    };
    expectRefused(withConfig("[scan]\nmax_range = 1.5x\n"), 2, {"scan.max_range", "1.5x"});
    expectRefused(withConfig("[scan]\nmax_ragne = 15\n"), 2, {"scan.max_ragne"});
    expectRefused(withConfig("max_range = 15\n"), 2, {"line 1"});
    expectRefused(withConfig("[scan]\nmax_range 15\n"), 2, {"line 2"});
    expectRefused(slam({"--start", "-1"}), 2, {"-1"});
    expectRefused(slam({"--threads", "-1"}), 2, {"-1"});
    expectRefused(slam({"--every", "0"}), 2, {"--every"});
    expectRefused(slam({"--count", "x"}), 2, {"x"});
    expectRefused(slam({"--ground-truth-frame", "imu"}), 2, {"imu"});
    expectRefused(slam({"--mapless"}), 2, {"mapless"});
    expectRefused(runTool("delio-slam", {"-o", out_}), 2, {"input"});
    EXPECT_EQ(withConfig("").exitCode, 0);
}

TEST_F(DelioSlam, RefusesWhatIsNoRawlog) {
    expectRefused(slam(), 1, {rawlog_, "no such file"});
    expectRefused(slamOf(folder_.path()), 1, {"no file"});
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
                const auto xyzi = test::toyScan(mrpt::poses::CPose3D::FromTranslation(i, 0, 0));
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
    EXPECT_NE(first.err.find("warning: scans of sensor 'rear' were not used"), std::string::npos)
        << first.err;
    EXPECT_NE(first.err.find("meta.yaml"), std::string::npos) << first.err;
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
        EXPECT_EQ(csv.at("reason"), Words({"", "", "no points", "", "no points", ""}));
        EXPECT_EQ(csv.at("points")[2], "0");
        EXPECT_EQ(csv.at("not_finite")[4], std::to_string(scans[4].size() / 4));
        EXPECT_EQ(csv.at("not_finite")[5], "2");
        EXPECT_EQ(summary()["predicted"].as<int>(), 2);
        EXPECT_TRUE(summary()["complete"].as<bool>());
        EXPECT_NEAR(io::readTrajectory(out_ / "trajectory_kitti.txt").poses.back().x(), 5, 0.5);
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

TEST_F(DelioSlam, OneScanIsADrive) {
    writeDrive(1);
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.out.find("nan"), std::string::npos) << run.out;
    EXPECT_EQ(rows("trajectory_kitti.txt"), 1U);
    EXPECT_TRUE(fs::exists(out_ / "map.png"));
    EXPECT_TRUE(summary()["complete"].as<bool>());
    EXPECT_EQ(readText(out_ / "summary.yaml").find("nan"), std::string::npos);
}

TEST_F(DelioSlam, AStandingVehicleHasNoRelativeErrors) {
    writeDrive(rawlog_, test::toyScans(3, 0.002));
    const std::string still = "1 0 0 0 0 1 0 0 0 0 1 0\n";
    writeText(folder_ / "d.poses.txt", still + still + still);
    const auto run = slam();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.out.find("nan"), std::string::npos) << run.out;
    EXPECT_EQ(readText(out_ / "summary.yaml").find("nan"), std::string::npos);
    EXPECT_LT(summary()["metrics"]["end_error_m"].as<double>(), 0.1);
}

TEST_F(DelioSlam, GroundTruth) {
    writeDrive(6);
    const fs::path truth = folder_ / "truth.txt";
    const std::string poses = readText(folder_ / "d.poses.txt");
    const auto with = [&](const std::string& text, const Words& more = {}) {
        writeText(truth, text);
        return slam(Words{"--ground-truth", truth, "--force"} + more);
    };
    std::string ofVehicle, tum;
    for (int i = 0; i < 6; ++i) {
        ofVehicle += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
        tum += std::to_string(0.1 * i) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
    }
    for (const auto& run : {with(poses), with(ofVehicle, {"--ground-truth-frame", "vehicle"}),
                            with(tum, {"--ground-truth-frame", "vehicle"})}) {
        EXPECT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.out.find("APE"), std::string::npos) << run.out;
    }
    EXPECT_LT(summary()["metrics"]["ape_m"].as<double>(), 0.3);

    // What cannot be right ends the run before it begins.
    fs::remove_all(out_);
    expectRefused(slam({"--ground-truth", folder_ / "none.txt"}), 1, {"none.txt"});
    expectRefused(with("1 2 3\n"), 1, {"truth.txt', line 1"});
    expectRefused(with(""), 1, {"truth.txt", "empty"});
    // What shows only later costs the evaluation, not the drive's results.
    for (const auto& run : {with(ofVehicle), with(poses, {"--ground-truth-frame", "vehicle"})}) {
        test::expectFailure(run, 1, {"--ground-truth-frame"});
        EXPECT_EQ(rows("trajectory_kitti.txt"), 6U);
        EXPECT_FALSE(summary().has("metrics"));
        EXPECT_TRUE(summary().has("fault"));
    }
    const std::string short_ = poses.substr(0, poses.find('\n') + 1);
    test::expectFailure(with(short_), 1, {"1 rows", "scan 5"});
    EXPECT_EQ(rows("trajectory_kitti.txt"), 6U);
    // The poses beside the rawlog were not asked for: a warning.
    writeText(folder_ / "d.poses.txt", short_);
    const auto beside = slam({"--force"});
    EXPECT_EQ(beside.exitCode, 0) << beside.err;
    EXPECT_NE(beside.err.find("no evaluation"), std::string::npos) << beside.err;
    EXPECT_EQ(summary()["warnings"].size(), 1U);
}

TEST_F(DelioSlam, ACalibrationWithoutTr) {
    writeDrive(3);
    const std::string poses = readText(folder_ / "d.poses.txt");
    writeText(folder_ / "d.calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    const auto run = slam();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("has no Tr"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(out_ / "trajectory_kitti_cam0.txt"));
    EXPECT_FALSE(summary().has("metrics"));
    EXPECT_EQ(summary()["warnings"].size(), 2U);  // also: no evaluation
    fs::remove_all(out_);
    expectRefused(slam({"--ground-truth", folder_ / "d.poses.txt"}), 1, {"Tr", "vehicle"});
    writeText(folder_ / "d.calib.txt", "Tr: 1 0 0 zero\n");
    expectRefused(slam(), 1, {"d.calib.txt', line 1", "zero"});
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

TEST_F(DelioSlam, OutputFolder) {
    writeDrive(1);
    fs::create_directories(out_);
    EXPECT_EQ(slam().exitCode, 0);  // an empty one is as good as none
    const auto before = readText(out_ / "summary.yaml");
    test::expectFailure(slam(), 1, {out_, "--force"});
    EXPECT_EQ(readText(out_ / "summary.yaml"), before);
    const auto into = [&](const std::string& out) {
        return runTool("delio-slam", Words{"-i", rawlog_, "-o", out, "--force"} + quick());
    };
    EXPECT_EQ(into(folder_ / "a" / "b" / "").exitCode, 0);
    EXPECT_TRUE(fs::exists(folder_ / "a" / "b" / "summary.yaml"));
    test::expectFailure(into(rawlog_), 1, {"no folder"});
    test::expectFailure(into("/proc/out"), 1, {"/proc/out"});
    test::expectFailure(into(rawlog_ / "out"), 1, {"d.rawlog/out"});
    test::expectFailure(into(""), 1, {"cannot write"});
}

TEST_F(DelioSlam, TimesThatDoNotRise) {
    const auto scans = test::toyScans(4);
    for (const auto& times :
         {std::vector<double>{0, 0.1, 0.1, 0.2}, std::vector<double>{0.3, 0.2, 0.1, 0.0}}) {
        writeDrive(rawlog_, scans, false, times);
        const auto run = slam({"--force"});
        EXPECT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.err.find("is not later than the one before"), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(out_ / "trajectory_tum.txt"));
        EXPECT_EQ(rows("trajectory_kitti.txt"), 4U);
        EXPECT_TRUE(summary().has("metrics"));  // KITTI's truth goes by rows
    }
}

TEST_F(DelioSlam, CtrlCKeepsWhatWasDone) {
    writeDrive(2);
    {
        // The same two scans many times over.
        mrpt::io::CFileOutputStream out(rawlog_.string());
        auto archive = mrpt::serialization::archiveFrom(out);
        for (int i = 0; i < 400; ++i) {
            mrpt::obs::CObservationPointCloud scan;
            scan.sensorLabel = "velodyne";
            scan.timestamp = mrpt::Clock::fromDouble(io::kDriveEpoch_s + 0.1 * i);
            scan.setAsExternalStorage(
                test::scanName(static_cast<std::size_t>(i % 2)),
                mrpt::obs::CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
            archive << scan;
        }
    }
    const auto run = runTool(
        "delio-slam", Words{"-i", rawlog_, "-o", out_, "--set", "graph.skip_edges=0"} + quick(),
        "delio-slam: scans ");
    EXPECT_EQ(run.exitCode, 130) << run.err;
    EXPECT_EQ(test::errorOf(run), "");
    const auto scans = summary()["scans"].as<int>();
    EXPECT_GE(scans, 20);
    EXPECT_LT(scans, 400);
    expectPart(static_cast<std::size_t>(scans));
}

TEST_F(DelioSlam, OptimisesAGraphAgain) {
    writeDrive(4);
    ASSERT_EQ(slam().exitCode, 0);
    const fs::path graph = out_ / "posegraph.g2o";
    const std::string text = readText(graph);
    fs::copy_file(graph, folder_ / "g.g2o");
    fs::create_directories(folder_ / "again");
    const auto again = [&] {
        return runTool("delio-slam", {"-i", folder_ / "g.g2o", "-o", folder_ / "again", "--force"});
    };
    writeText(folder_ / "again" / "scans.csv", "of another run\n");
    const auto run = again();
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto before = io::readTrajectory(out_ / "trajectory_kitti.txt").poses;
    const auto after = io::readTrajectory(folder_ / "again" / "trajectory_kitti.txt").poses;
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_LT(before[i].distanceEuclidean6D(after[i]), 1e-3);
    EXPECT_EQ(test::namesIn(folder_ / "again"),
              Words({"config.ini", "posegraph.g2o", "posegraph.graph", "summary.yaml",
                     "trajectory.png", "trajectory_kitti.txt", "trajectory_odometry_kitti.txt"}));
    const auto result = yaml::FromFile(folder_ / "again" / "summary.yaml");
    EXPECT_TRUE(result["complete"].as<bool>());
    EXPECT_EQ(result["scans"].as<int>(), 4);

    fs::remove_all(folder_ / "again");
    const auto broken = [&](const std::string& bytes, const Words& words) {
        writeText(folder_ / "g.g2o", bytes);
        test::expectFailure(again(), 1, words);
        EXPECT_FALSE(fs::exists(folder_ / "again"));
    };
    broken("", {"g.g2o", "VERTEX"});
    broken("words\n", {"line 1", "words"});
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string bytes = text;
        const auto at = bytes.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return bytes.replace(at, from.size(), to);
    };
    const std::string edge = text.substr(text.find("EDGE_SE3:QUAT 2 3"));
    const std::string line = edge.substr(0, edge.find('\n') + 1);
    const std::string head = "EDGE_SE3:QUAT 2 3 1 0 0 0 0 0 1 ";
    broken(changed(line, ""), {"no edges connect node 3"});
    broken(changed(line, head + "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 nan 0 0 1 0 1\n"), {"not finite"});
    broken(changed(line, head + "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 -1 0 0 1 0 1\n"),
           {"node 2 to node 3", "positive definite"});
    broken(text.substr(0, text.size() - 2), {"the file ends within this line"});
    broken(text.substr(0, text.size() / 2), {"g.g2o', line"});
    broken(text + "EDGE_SE3:QUAT 0 99 0 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n",
           {"99"});

    // Results of an earlier run stay.
    fs::create_directories(folder_ / "again");
    writeText(folder_ / "again" / "trajectory_kitti.txt", "precious\n");
    writeText(folder_ / "g.g2o", "words\n");
    test::expectFailure(again(), 1, {"words"});
    EXPECT_EQ(readText(folder_ / "again" / "trajectory_kitti.txt"), "precious\n");
    EXPECT_EQ(test::namesIn(folder_ / "again"), Words({"trajectory_kitti.txt"}));
}

TEST(EveryTool, HelpAndVersion) {
    for (const std::string tool : {"kitti2rawlog", "rawlog2kitti", "synth2rawlog", "delio-slam",
                                   "delio-eval", "delio-snapshot"}) {
        const auto help = runTool(tool, {"--help"});
        EXPECT_EQ(help.exitCode, 0) << tool;
        EXPECT_EQ(help.err, "") << tool;
        for (const std::string option : {"--help", "--version", "--verbose"})
            EXPECT_NE(help.out.find(option), std::string::npos) << tool << option;
        const auto version = runTool(tool, {"--version"});
        EXPECT_EQ(version.exitCode, 0) << tool;
        EXPECT_EQ(version.out, tool + " 0.1.0\n");
        EXPECT_EQ(version.err, "") << tool;
        const auto nothing = runTool(tool, {});
        test::expectFailure(nothing, 2, {"--help"});
        EXPECT_EQ(nothing.out, "") << tool;
    }
}
// The limit is reached by key scans that are put aside, by files of the map, or by small files.
TEST_F(DelioSlam, AFullDiskLeavesNothingHalfWritten) {
    writeDrive();
    for (const std::size_t kilobytes : {1, 8, 100, 300, 600, 1000}) {
        fs::remove_all(out_);
        const auto run = test::runToolOnFullDisk(
            "delio-slam", {"-i", rawlog_, "-o", out_, "--set", "map.voxel_size=0"},
            kilobytes * 1024);
        EXPECT_EQ(run.exitCode, 1) << kilobytes << run.err;
        const bool spool = run.err.find("cannot put key scans aside") != std::string::npos;
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
}  // namespace
