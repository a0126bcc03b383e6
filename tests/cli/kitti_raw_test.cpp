// kitti2rawlog on KITTI's layout of raw drives.
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "kitti_tools.h"
#include "poses.h"

namespace {
using namespace delio;
using test::fewPoints;
using test::runTool;
using test::Words;
using test::writeText;
namespace fs = std::filesystem;

/** A drive in KITTI's raw layout with known poses of the OXTS unit; scan 2 is missing. */
class KittiRaw : public testing::Test {
 protected:
    static constexpr double kLat = 49.011, kLon = 8.417, kEpoch_s = 1317042145.951199337;

    void SetUp() override {
        fs::create_directories(drive_ / "velodyne_points" / "data");
        fs::create_directories(drive_ / "oxts" / "data");
        std::string times;
        for (std::size_t i = 0; i < 6; ++i) {
            const std::string name = "000000000" + std::to_string(i);
            char time[64];
            std::snprintf(time, sizeof(time), "2011-09-26 13:02:%012.9f",
                          25.951199337 + 0.1 * static_cast<double>(i));
            // KITTI leaves the line of a missing scan empty.
            times += (i == 2 ? std::string() : std::string(time)) + "\n";
            writeText(drive_ / "oxts" / "data" / (name + ".txt"), oxtsRow(i));
            if (i != 2)
                test::writeFloats(drive_ / "velodyne_points" / "data" / (name + ".bin"),
                                  fewPoints(i));
        }
        writeText(drive_ / "velodyne_points" / "timestamps.txt", times);
        writeText(date_ / "calib_velo_to_cam.txt",
                  "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\n"
                  "T: -0.004 -0.076 -0.272\ndelta_f: 0 0\n");
        writeText(date_ / "calib_imu_to_velo.txt",
                  "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -0.81 0.32 -0.8\n");
        writeText(date_ / "calib_cam_to_cam.txt",
                  "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
                  "R_rect_00: 0.8 0 0.6 0 1 0 -0.6 0 0.8\nR_rect_01: 1 0 0 0 1 0 0 0 1\n");
    }

    /** Where the OXTS unit is: east, north, up of the first, and its attitude. */
    static Eigen::Isometry3d imuPose(std::size_t i) {
        const auto n = static_cast<double>(i);
        const Attitude a = attitude(i);
        return test::poseAt(1.2 * n, 0.3 * n * n, 0.05 * n, a.yaw, a.pitch, a.roll);
    }

    struct Attitude {
        double yaw, pitch, roll;
    };
    static Attitude attitude(std::size_t i) {
        const auto n = static_cast<double>(i);
        return {0.3 + 0.1 * n, 0.01 * n, -0.02 * n};
    }

    /** The inverse of KITTI's Mercator. */
    static std::string oxtsRow(std::size_t i) {
        const Eigen::Vector3d at = imuPose(i).translation();
        const Attitude a = attitude(i);
        const double radius = 6378137.0, scale = std::cos(kLat * M_PI / 180) * radius;
        const double north = scale * std::log(std::tan(M_PI * (90 + kLat) / 360)) + at.y();
        const double lat = std::atan(std::exp(north / scale)) * 360 / M_PI - 90;
        const double lon = kLon + at.x() / scale * 180 / M_PI;
        char row[256];
        std::snprintf(row, sizeof(row),
                      "%.15g %.15g %.15g %.15g %.15g %.15g 0 0 0 0 0 "
                      "0.1 0.2 9.8 0 0 0 0.01 0.02 %.15g 0 0 0 0.05 0.1 4 8 4 4 0\n",
                      lat, lon, 116.0 + at.z(), a.roll, a.pitch, a.yaw,
                      0.1 * static_cast<double>(i));
        return row;
    }

    test::CommandResult convert(const Words& more = {}) const {
        Words words = {"-i", drive_, "-o", rawlog_};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("kitti2rawlog", words);
    }

    test::TemporaryFolder folder_;
    fs::path date_ = folder_ / "2011_09_26";
    fs::path drive_ = date_ / "2011_09_26_drive_0009_sync";
    fs::path rawlog_ = folder_ / "d.rawlog";
};

TEST_F(KittiRaw, CalibrationPosesAndTimes) {
    const auto run = convert();
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.err.find("warning"), std::string::npos) << run.err;
    // R_rect_00 * velo_to_cam, by hand.
    Eigen::Matrix4d wanted;
    wanted << 0.6, -0.8, 0, -0.8 * 0.004 - 0.6 * 0.272, 0, 0, -1, -0.076, 0.8, 0.6, 0,
        0.6 * 0.004 - 0.8 * 0.272, 0, 0, 0, 1;
    const auto calibration = io::readCalibration(folder_ / "d.calib.txt");
    ASSERT_TRUE(calibration.hasTr);
    EXPECT_LT((calibration.Tr.matrix() - wanted).cwiseAbs().maxCoeff(), 1e-9);

    const std::vector<std::size_t> numbers = {0, 1, 3, 4, 5};
    const Eigen::Isometry3d imuToCam = calibration.Tr * test::poseAt(-0.81, 0.32, -0.8);
    const auto poses = io::readTrajectory(folder_ / "d.poses.txt").poses;
    ASSERT_EQ(poses.size(), numbers.size());
    EXPECT_LT(poses[0].translation().norm(), 1e-6);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const Eigen::Isometry3d truth =
            imuToCam * imuPose(0).inverse() * imuPose(numbers[i]) * imuToCam.inverse();
        const double metres = test::metresBetween(poses[i], truth);
        const double radians = test::degreesBetween(poses[i], truth) * M_PI / 180;
        EXPECT_LT(std::hypot(metres, radians), 1e-3) << i;
    }

    const auto times = io::readTimes(folder_ / "d.times.txt");
    ASSERT_EQ(times.size(), numbers.size());
    EXPECT_EQ(times[0], 0);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        EXPECT_NEAR(times[i], 0.1 * static_cast<double>(numbers[i]), 1e-6);
    const auto meta = io::readDriveMeta(rawlog_);
    ASSERT_TRUE(meta);
    EXPECT_EQ(meta->source, "kitti-raw");
    EXPECT_FALSE(meta->motionCompensated);
    EXPECT_NEAR(meta->epoch_s, kEpoch_s, 1e-6);
}

// One per row of OXTS, also where a scan is missing; fixes only with the scans.
TEST_F(KittiRaw, FixesAndRatesOfOxts) {
    std::string times;
    for (int i = 0; i < 6; ++i) times += "2011-09-26 13:02:26." + std::to_string(i) + "00000000\n";
    writeText(drive_ / "oxts" / "timestamps.txt", times);
    writeText(drive_ / "oxts" / "data" / "0000000004.txt", "49 8 116 0 0 0\n");
    ASSERT_EQ(convert().exitCode, 0);
    const auto reader = io::openScans(rawlog_.string());
    std::vector<ImuSample> rates;
    earth::Fixes fixes;
    for (bool more = true; more;) {
        more = reader->next().has_value();
        for (const auto& rate : reader->takeImu()) rates.push_back(rate);
        for (const auto& fix : reader->takeFixes()) fixes.push_back(fix);
    }
    ASSERT_EQ(fixes.size(), 5U);
    EXPECT_NEAR(fixes[1].place.latitude_deg, kLat, 1e-4);
    EXPECT_NEAR(fixes[1].place.height_m, 116.05, 1e-9);
    EXPECT_NEAR(fixes[1].covariance(0, 0), 0.05 * 0.05, 1e-9);
    EXPECT_TRUE(fixes[1].antenna->isApprox(Eigen::Vector3d(-0.81, 0.32, -0.8)));
    ASSERT_EQ(rates.size(), 5U);  // row 4 is too short
    for (std::size_t i = 0; i < rates.size(); ++i) {
        const double row = i < 4 ? static_cast<double>(i) : 5;
        EXPECT_NEAR(rates[i].stamp_s, 0.048800663 + 0.1 * row, 1e-6);
        EXPECT_TRUE(rates[i].rate_radps.isApprox(Eigen::Vector3d(0.01, 0.02, 0.1 * row)));
        EXPECT_TRUE(rates[i].acceleration_mps2.isApprox(Eigen::Vector3d(0.1, 0.2, 9.8)));
        ASSERT_TRUE(rates[i].sensorPose);
        EXPECT_TRUE(rates[i].sensorPose->isApprox(test::poseAt(-0.81, 0.32, -0.8)));
    }
}

TEST_F(KittiRaw, TimesComeBackAlsoFromAFractionalEpoch) {
    ASSERT_EQ(convert().exitCode, 0);
    const auto times = io::readTimes(folder_ / "d.times.txt");
    fs::remove(folder_ / "d.times.txt");
    ASSERT_EQ(runTool("rawlog2kitti", {"-i", rawlog_, "-o", folder_ / "back"}).exitCode, 0);
    const auto back = io::readTimes(folder_ / "back" / "times.txt");
    ASSERT_EQ(back.size(), times.size());
    for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], times[i], 1e-6);

    // Without the epoch: Unix seconds.
    fs::remove(folder_ / "d.meta.yaml");
    ASSERT_EQ(runTool("rawlog2kitti", {"-i", rawlog_, "-o", folder_ / "unix"}).exitCode, 0);
    EXPECT_NEAR(io::readTimes(folder_ / "unix" / "times.txt")[0], kEpoch_s, 1e-6);
}

TEST_F(KittiRaw, StartCountsFilesAndPosesBeginAtIt) {
    ASSERT_EQ(convert({"--start", "2", "--count", "2"}).exitCode, 0);  // files 3 and 4
    EXPECT_NEAR(io::readDriveMeta(rawlog_)->epoch_s, kEpoch_s + 0.3, 1e-6);
    const auto poses = io::readTrajectory(folder_ / "d.poses.txt").poses;
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_LT(poses[0].translation().norm(), 1e-6);
    EXPECT_NEAR(poses[1].translation().norm(), test::metresBetween(imuPose(3), imuPose(4)), 0.2);
}

TEST_F(KittiRaw, MissingPartsAreWarningsAndBrokenOnesErrors) {
    fs::remove(drive_ / "oxts" / "data" / "0000000003.txt");
    auto run = convert();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("warning: '" + (drive_ / "oxts/data/0000000003.txt").string()),
              std::string::npos)
        << run.err;
    EXPECT_FALSE(fs::exists(folder_ / "d.poses.txt"));
    const auto inPlace =
        runTool("delio-slam", {"-i", drive_, "-o", folder_ / "out", "--no-map", "--count", "1"});
    EXPECT_NE(inPlace.err.find("0000000003.txt' not found"), std::string::npos) << inPlace.err;
    writeText(drive_ / "oxts" / "data" / "0000000003.txt", "49 8 north\n");
    test::expectFailure(convert({"--force"}), 1, {"0000000003.txt", "six numbers"});
    fs::remove_all(drive_ / "oxts");

    fs::rename(date_ / "calib_cam_to_cam.txt", date_ / "kept");
    run = convert({"--force"});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("calib_cam_to_cam.txt"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(folder_ / "d.calib.txt"));
    writeText(date_ / "calib_cam_to_cam.txt", "R_rect_00: 1 0 0\n");
    test::expectFailure(convert({"--force"}), 1, {"calib_cam_to_cam.txt", "R_rect_00"});
    fs::rename(date_ / "kept", date_ / "calib_cam_to_cam.txt");

    writeText(drive_ / "velodyne_points" / "timestamps.txt",
              "2011-09-26 13:02:25.9\nnoon\n\n\n\n\n");
    test::expectFailure(convert({"--force"}), 1, {"timestamps.txt", "noon"});
    fs::remove(drive_ / "velodyne_points" / "timestamps.txt");
    EXPECT_EQ(convert({"--force"}).exitCode, 0);
    EXPECT_EQ(io::readTimes(folder_ / "d.times.txt"), (std::vector<double>{0, 0.1, 0.3, 0.4, 0.5}));
}
}  // namespace
