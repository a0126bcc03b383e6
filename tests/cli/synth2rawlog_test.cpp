#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "command.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;

using Points = std::vector<Eigen::Vector3d>;

test::CommandResult synth(const fs::path& output, std::vector<std::string> more) {
    std::vector<std::string> words = {"-o", output.string(), "--scene", "urban"};
    words.insert(words.end(), more.begin(), more.end());
    return runTool("synth2rawlog", words);
}

Points pointsOf(const fs::path& file) {
    const std::string bytes = test::readText(file);
    std::vector<float> xyzi(bytes.size() / sizeof(float));
    std::memcpy(xyzi.data(), bytes.data(), bytes.size());
    Points points;
    for (std::size_t i = 0; i + 3 < xyzi.size(); i += 4)
        points.emplace_back(xyzi[i], xyzi[i + 1], xyzi[i + 2]);
    return points;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

/** Every `step`-th point from 3 to 20 m. */
Points nearby(const Points& points, std::size_t step) {
    Points some;
    for (std::size_t i = 0; i < points.size(); i += step)
        if (points[i].norm() > 3 && points[i].norm() < 20) some.push_back(points[i]);
    return some;
}

/** Median distance from `from`, moved by `pose`, to its nearest in `to`, at a wall's height. */
double misfit(const Points& from, const Eigen::Isometry3d& pose, const Points& to) {
    std::vector<double> distances;
    for (const auto& point : from) {
        if (point.z() < -1.2) continue;  // level ground fits anywhere
        const Eigen::Vector3d moved = pose * point;
        double nearest = 1e9;
        for (const auto& other : to) nearest = std::min(nearest, (moved - other).squaredNorm());
        distances.push_back(std::sqrt(nearest));
    }
    return median(distances);
}

/** Of the LiDAR, from `later` to `earlier`. */
Eigen::Isometry3d motionBetween(const Eigen::Isometry3d& earlier, const Eigen::Isometry3d& later,
                                const Eigen::Isometry3d& Tr) {
    return Tr.inverse() * earlier.inverse() * later * Tr;
}

/** How far, along their rays, points on the near ground lie off the plane of their neighbours in
 *  `others`: a robust standard deviation. */
double groundNoise(const Points& points, const Points& others) {
    std::vector<double> residuals;
    for (std::size_t i = 0; i < points.size(); i += 50) {
        const auto& p = points[i];
        const double level = p.head<2>().norm();
        if (level < 4 || level > 9 || p.z() > -1.5 || p.z() < -2 || std::abs(p.y()) > 3) continue;
        Points around;
        for (const auto& q : others)
            if ((q - p).norm() < 0.6) around.push_back(q);
        if (around.size() < 30) continue;
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const auto& q : around) centre += q / static_cast<double>(around.size());
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        for (const auto& q : around) scatter += (q - centre) * (q - centre).transpose();
        const Eigen::Vector3d normal =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
        // The noise lies along the ray: what stands off the plane is its slanted share.
        residuals.push_back((p - centre).dot(normal) / normal.dot(p.normalized()));
    }
    EXPECT_GT(residuals.size(), 50U);
    for (auto& r : residuals) r = std::abs(r);
    return 1.4826 * median(residuals);
}

TEST(Synth2rawlog, GivesTheSameBytesForAnyNumberOfThreads) {
    const test::TemporaryFolder folder;
    for (const std::string threads : {"1", "2", "3"}) {
        fs::create_directory(folder / threads);
        const auto run =
            synth(folder / threads / "d.rawlog", {"--scans", "4", "--threads", threads});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        EXPECT_EQ(run.out, "");
    }
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "1")) {
        if (!entry.is_regular_file()) continue;
        const auto name = fs::relative(entry.path(), folder / "1");
        for (const std::string threads : {"2", "3"})
            EXPECT_EQ(test::readText(entry.path()), test::readText(folder / threads / name))
                << name;
        ++files;
    }
    EXPECT_EQ(files, 2 * 4U + 7U);  // points and rings of each scan; rawlog and side files
}

TEST(Synth2rawlog, SideFilesAreConsistent) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "d.rawlog";
    const auto run = synth(rawlog, {"--scans", "5", "--seed", "9"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto poses = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    const auto times = io::readTimes(io::sidecarPath(rawlog, ".times.txt"));
    ASSERT_EQ(poses.size(), 5U);
    ASSERT_EQ(times.size(), 5U);
    EXPECT_LT(poses[0].translation().norm(), 1e-12);
    EXPECT_NEAR(poses[0](0, 0), 1, 1e-12);
    EXPECT_GT(poses[4].translation().z(), poses[3].translation().z());  // cam0 looks along z
    EXPECT_DOUBLE_EQ(times[4], 0.4);
    EXPECT_TRUE(io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).hasTr);
    const auto meta = io::readDriveMeta(rawlog);
    ASSERT_TRUE(meta);
    EXPECT_EQ(meta->sensorModel, "HDL-64E");
    EXPECT_EQ(meta->source, "synthetic");
    EXPECT_TRUE(meta->motionCompensated);
    EXPECT_EQ(meta->verticalCorrectionDeg, 0);
    for (int i = 0; i < 5; ++i) {
        const auto points = pointsOf(folder / "d_Images" / ("00000" + std::to_string(i) + ".bin"));
        EXPECT_GT(points.size(), 80000U);
        EXPECT_LT(points.size(), 130000U);
    }
}

TEST(Synth2rawlog, TheTruthMakesScansCoincide) {
    const test::TemporaryFolder folder;
    const auto run = synth(folder / "d.rawlog", {"--scans", "40"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto cam0 = io::readTrajectory(folder / "d.poses.txt").poses;
    const auto Tr = io::readCalibration(folder / "d.calib.txt").Tr;
    const auto truth = motionBetween(cam0[38], cam0[39], Tr);
    EXPECT_GT(truth.translation().x(), 0.4);
    const auto to = nearby(pointsOf(folder / "d_Images/000038.bin"), 1);
    const auto from = nearby(pointsOf(folder / "d_Images/000039.bin"), 25);
    const double right = misfit(from, truth, to);
    EXPECT_LT(right, 0.06);
    EXPECT_GT(misfit(from, Eigen::Isometry3d::Identity(), to), 1.5 * right);
    for (const Eigen::Vector3d axis :
         {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}) {
        const Eigen::Isometry3d turned = truth * Eigen::AngleAxisd(0.04, axis);
        EXPECT_GT(misfit(from, turned, to), 1.3 * right) << axis.transpose();
    }
    EXPECT_GT(misfit(from, Eigen::Translation3d(0, 0.4, 0) * truth, to), 1.5 * right);
}

TEST(Synth2rawlog, WithoutNoiseTheGroundIsTheSameInAllScans) {
    const test::TemporaryFolder folder;
    const auto run = synth(folder / "d.rawlog", {"--scans", "40", "--noise", "0"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto poses = io::readTrajectory(folder / "d.poses.txt").poses;
    const auto Tr = io::readCalibration(folder / "d.calib.txt").Tr;
    const auto truth = motionBetween(poses[36], poses[39], Tr);
    auto moved = pointsOf(folder / "d_Images/000039.bin");
    for (auto& point : moved) point = truth * point;
    EXPECT_LT(groundNoise(moved, pointsOf(folder / "d_Images/000036.bin")), 2e-3);
}

TEST(Synth2rawlog, RangesAreAsNoisyAsAsked) {
    const test::TemporaryFolder folder;
    for (const double noise : {0.02, 0.05}) {
        const auto run = synth(folder / "d.rawlog",
                               {"--scans", "1", "--noise", std::to_string(noise), "--force"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        const auto points = pointsOf(folder / "d_Images/000000.bin");
        EXPECT_NEAR(groundNoise(points, points), noise, 0.3 * noise);
    }
}

TEST(Synth2rawlog, EmbeddedPointsAreTheSame) {
    const test::TemporaryFolder folder;
    ASSERT_EQ(synth(folder / "a.rawlog", {"--scans", "2"}).exitCode, 0);
    ASSERT_EQ(synth(folder / "b.rawlog", {"--scans", "2", "--embed"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(folder / "b_Images/000000.bin"));
    EXPECT_EQ(test::readText(folder / "a_Images/000001.ring"),
              test::readText(folder / "b_Images/000001.ring"));
    io::RawlogReader external(folder / "a.rawlog"), embedded(folder / "b.rawlog");
    for (int i = 0; i < 2; ++i) {
        const auto a = external.next(), b = embedded.next();
        ASSERT_TRUE(a && b);
        EXPECT_EQ(a->stamp_s, b->stamp_s);
        EXPECT_EQ(a->points->getPointsBufferRef_x(), b->points->getPointsBufferRef_x());
        EXPECT_EQ(a->points->getPointsBufferRef_z(), b->points->getPointsBufferRef_z());
    }
    EXPECT_FALSE(external.next());
    EXPECT_EQ(test::readText(folder / "a.poses.txt"), test::readText(folder / "b.poses.txt"));
}

TEST(Synth2rawlog, ABadCommandLineIsOneLineAndExit2) {
    const test::TemporaryFolder folder;
    const auto expectRefused = [&](const std::vector<std::string>& words, const std::string& part) {
        std::vector<std::string> all = {"-o", (folder / "d.rawlog").string()};
        all.insert(all.end(), words.begin(), words.end());
        const auto run = runTool("synth2rawlog", all);
        EXPECT_EQ(run.exitCode, 2) << run.err;
        EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
        EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
        EXPECT_TRUE(fs::is_empty(folder.path()));
    };
    expectRefused({"--scene", "moon", "--scans", "3"}, "urban");
    expectRefused({"--scene", "urban", "--scans", "3", "--sensor", "vlp1"}, "hdl64e");
    expectRefused({"--scene", "urban", "--scans", "0"}, "--scans");
    expectRefused({"--scene", "urban", "--scans", "x"}, "scans");
    expectRefused({"--scene", "urban"}, "required");
    expectRefused({"--scene", "urban", "--scans", "3", "--noise", "-0.1"}, "--noise");
    expectRefused({"--scene", "urban", "--scans", "3", "--noise", "nan"}, "noise");
    expectRefused({"--scene", "urban", "--scans", "3", "--ring-bias", "-0.1"}, "--ring-bias");
    expectRefused({"--scene", "urban", "--scans", "3", "--movers", "-1"}, "--movers");
    expectRefused({"--scene", "urban", "--scans", "3", "--drop-rate", "1"}, "--drop-rate");
    for (const char* gap : {"3", "0,1", "1,0", "1,2,3", "1;2", "a,b"})
        expectRefused({"--scene", "urban", "--scans", "3", "--gap", gap}, "--gap");
    expectRefused({"--scene", "urban", "--scans", "3", "--repeat-rate", "-0.1"}, "--repeat-rate");
    expectRefused({"--scene", "urban", "--scans", "3", "--empty-rate", "nan"}, "empty-rate");
    expectRefused({"--scene", "urban", "--scans", "3", "--threads", "-1"}, "--threads");
    expectRefused({"--scene", "urban", "--scans", "3", "--tunnel"}, "tunnel");
}

TEST(Synth2rawlog, AnExistingOrUnwritableOutputIsOneLineAndExit1) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "d.rawlog", "mine");
    const auto exists = synth(folder / "d.rawlog", {"--scans", "1"});
    EXPECT_EQ(exists.exitCode, 1);
    EXPECT_TRUE(test::isOneLine(exists.err)) << exists.err;
    EXPECT_NE(exists.err.find("--force"), std::string::npos);
    EXPECT_EQ(test::readText(folder / "d.rawlog"), "mine");
    EXPECT_EQ(synth(folder / "d.rawlog", {"--scans", "1", "--force"}).exitCode, 0);

    const auto nowhere = synth(folder / "none" / "d.rawlog", {"--scans", "1"});
    EXPECT_EQ(nowhere.exitCode, 1);
    EXPECT_TRUE(test::isOneLine(nowhere.err)) << nowhere.err;
}

TEST(Synth2rawlog, AnInterruptLeavesNothing) {
    const test::TemporaryFolder folder;
    const auto run = runTool(
        "timeout", {"-s", "INT", "--preserve-status", "1", test::toolPath("synth2rawlog"), "-o",
                    (folder / "d.rawlog").string(), "--scene", "urban", "--scans", "100000"});
    EXPECT_EQ(run.exitCode, 130) << run.err;
    EXPECT_TRUE(fs::is_empty(folder.path()));
}
}  // namespace
