// delio-slam: the files of the contract, and which scans go into them.
#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "delio/formats/trajectory.h"
#include "delio/version.h"
#include "delio_slam_fixture.h"

namespace {
using namespace delio;
using test::csvColumns;
using test::DelioSlam;
using test::linesOf;
using test::readText;
using test::runTool;
using test::Words;
using test::writeText;
using test::operator+;
namespace fs = std::filesystem;

/** In all its frames and formats the trajectory is the same. */
void expectTrajectories(const fs::path& out, const fs::path& drive, std::size_t scans) {
    EXPECT_EQ(linesOf(readText(out / "trajectory_kitti.txt"))[0], "1 0 0 0 0 1 0 0 0 0 1 0");
    const auto lidar = io::readTrajectory(out / "trajectory_kitti.txt");
    EXPECT_NEAR(lidar.poses.back().translation().x(), static_cast<double>(scans - 1), 0.3);
    const auto tum = io::readTrajectory(out / "trajectory_tum.txt");
    EXPECT_EQ(tum.stamps_s, io::readTimes(drive / "d.times.txt"));
    const auto Tr = io::readCalibration(drive / "d.calib.txt").Tr;
    const auto cam0 = io::readTrajectory(out / "trajectory_kitti_cam0.txt");
    for (std::size_t i = 0; i < scans; ++i) {
        EXPECT_LT((lidar.poses[i].matrix() - tum.poses[i].matrix()).norm(), 1e-12);
        EXPECT_LT((cam0.poses[i].matrix() - (Tr * lidar.poses[i] * Tr.inverse()).matrix()).norm(),
                  1e-9);
    }
    const auto eval = runTool("delio-eval", {"--ref", out / "trajectory_kitti_cam0.txt", "--est",
                                             out / "trajectory_kitti.txt", "--calib",
                                             drive / "d.calib.txt", "--format", "tsv"});
    ASSERT_EQ(eval.exitCode, 0) << eval.err;
    EXPECT_NE(eval.out.find("\t0.000000000\t0.000000000\t0.000000000\n"), std::string::npos)
        << eval.out;
}

TEST_F(DelioSlam, LeavesTheFilesOfTheContract) {
    writeDrive();
    const auto run = runTool("delio-slam", {"-i", rawlog_, "-o", out_});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(test::errorOf(run), "");
    EXPECT_NE(run.out.find("scans"), std::string::npos);
    EXPECT_EQ(test::namesIn(out_),
              Words({"config.ini", "loops.csv", "map.3Dscene", "map.delio", "map.html", "map.ply",
                     "map.png", "map.simplemap", "map_removal.png", "posegraph.g2o",
                     "posegraph.graph", "scans.csv", "summary.yaml", "trajectory.png",
                     "trajectory_kitti.txt", "trajectory_kitti_cam0.txt", "trajectory_mrpt.txt",
                     "trajectory_odometry_kitti.txt", "trajectory_tum.txt"}));

    for (const char* name : {"trajectory_kitti.txt", "trajectory_odometry_kitti.txt",
                             "trajectory_kitti_cam0.txt", "trajectory_tum.txt"})
        EXPECT_EQ(rows(name), kScans) << name;
    expectTrajectories(out_, folder_.path(), kScans);

    const auto csv = csvColumns(out_ / "scans.csv");
    EXPECT_EQ(csv.at("scan"), Words({"0", "1", "2", "3", "4"}));
    EXPECT_EQ(csv.at("predicted"), Words(kScans, "0"));
    EXPECT_EQ(csv.at("reason"), Words(kScans, ""));

    const auto summary = this->summary();
    EXPECT_TRUE(summary["complete"].as<bool>());
    EXPECT_EQ(summary["version"].as<std::string>(), kVersion);
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

// Each method has its own stages and figures, and none that are always 0.
TEST_F(DelioSlam, ColumnsAndStagesAreThoseOfTheMethod) {
    writeDrive(2);
    const Words common = {"scan", "stamp_s", "points", "not_finite", "read_ms", "graph_ms"};
    const Words quality = {"matches",
                           "residual_m",
                           "rotation_observability_1",
                           "rotation_observability_2",
                           "rotation_observability_3",
                           "translation_observability_1",
                           "translation_observability_2",
                           "translation_observability_3",
                           "rotation_unobserved",
                           "translation_unobserved",
                           "searched",
                           "interrupted",
                           "standing",
                           "state",
                           "predicted",
                           "reason"};
    const std::map<std::string, std::pair<Words, Words>> own = {
        {"accurate",
         {{"preprocess", "undistort", "thinning", "points", "dynamic", "planes", "map_update"},
          {"converged", "dynamic", "dynamic_share", "inlier_ratio", "iterations", "kernel_m",
           "plane_converged", "plane_inlier_ratio", "plane_iterations", "scale"}}},
        {"paper",
         {{"preprocess", "normals", "bilateral", "outliers", "mean_shift", "lines", "rotation",
           "translation"},
          {"normals", "pattern", "modes", "lines", "overlap", "rotation_iterations",
           "rotation_converged", "translation_iterations", "translation_converged"}}},
        {"paper-extended",
         {{"preprocess", "normals", "bilateral", "outliers", "mean_shift", "lines", "check_points",
           "rotation", "translation", "guards"},
          {"normals", "pattern", "modes", "lines", "overlap", "rotation_iterations",
           "rotation_converged", "translation_iterations", "translation_converged", "denied"}}}};
    for (const auto& [profile, names] : own) {
        const auto& [stages, details] = names;
        ASSERT_EQ(slam({"--profile", profile, "--force"}).exitCode, 0);
        std::set<std::string> expected;
        for (const auto& list : {common, quality, details})
            expected.insert(list.begin(), list.end());
        for (const auto& stage : stages) expected.insert(stage + "_ms");
        if (profile == "accurate") expected.insert("submaps_ms");  // others close no loops
        std::set<std::string> found;
        for (const auto& [name, cells] : csvColumns(out_ / "scans.csv")) found.insert(name);
        EXPECT_EQ(found, expected) << profile;
        Words measured;
        const auto summary = this->summary();
        for (const auto& entry : summary["ms_per_scan_of_stages"].asMap())
            measured.push_back(entry.first.as<std::string>());
        auto inSummary = Words{"graph", "read"} + stages;
        if (profile == "accurate") inSummary.emplace_back("submaps");
        std::sort(inSummary.begin(), inSummary.end());
        std::sort(measured.begin(), measured.end());
        EXPECT_EQ(measured, inSummary) << profile;
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
    for (const char* stale : {"map.delio", "map.ply", "map_dynamic.ply", "map.html", "map.png",
                              "map_removal.png", "map.3Dscene", "map.simplemap"})
        writeText(out_ / stale, "of an earlier run");
    writeText(out_ / "mine.txt", "mine");
    const auto run = slam({"--no-graph", "--force"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    for (const char* name : {"map.delio", "map.ply", "map_dynamic.ply", "map.html", "map.png",
                             "map_removal.png", "map.3Dscene", "map.simplemap"})
        EXPECT_FALSE(fs::exists(out_ / name)) << name;
    EXPECT_TRUE(fs::exists(out_ / "trajectory.png"));
    EXPECT_TRUE(fs::exists(out_ / "mine.txt"));
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"),
              readText(out_ / "trajectory_odometry_kitti.txt"));
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
        "delio-slam", Words{"-i", rawlog_, "-o", out_, "--no-map", "--set", "graph.skip_edges=0"},
        "delio-slam: scans ");
    EXPECT_EQ(run.exitCode, 130) << run.err;
    const auto scans = summary()["scans"].as<int>();
    EXPECT_EQ(test::errorOf(run), "delio-slam: interrupted; the results cover the first " +
                                      std::to_string(scans) + " scans\n");
    EXPECT_GE(scans, 20);
    EXPECT_LT(scans, 400);
    expectPart(static_cast<std::size_t>(scans));
}
}  // namespace
