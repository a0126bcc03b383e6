// kitti2rawlog and rawlog2kitti: there and back, KITTI's layouts, and bad inputs.
#include <gtest/gtest.h>
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "command.h"
#include "delio/io/drive_meta.h"
#include "delio/io/scan_source.h"
#include "delio/io/trajectory.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
using test::Floats;
using test::runTool;
using test::writeText;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/** A few points, different for every scan. */
Floats fewPoints(std::size_t scan, std::size_t count = 5) {
    Floats points;
    for (std::size_t i = 0; i < 4 * count; ++i)
        points.push_back(0.1F * static_cast<float>(i) - 3.3F * static_cast<float>(scan));
    return points;
}

std::vector<Floats> fewScans(std::size_t count) {
    std::vector<Floats> scans;
    for (std::size_t i = 0; i < count; ++i) scans.push_back(fewPoints(i));
    return scans;
}

class KittiTools : public testing::Test {
 protected:
    void SetUp() override {
        test::writeSequence(seq_, fewScans(5));
        fs::create_directory(folder_ / "out");
    }

    test::CommandResult toRawlog(const Words& more = {}) const {
        Words words = {"-i", seq_, "-o", rawlog_};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("kitti2rawlog", words);
    }
    test::CommandResult toKitti(const fs::path& target, const Words& more = {}) const {
        Words words = {"-i", rawlog_, "-o", target};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("rawlog2kitti", words);
    }
    /** A failed conversion leaves nothing behind. */
    void expectRefused(const test::CommandResult& run, int exitCode, const Words& words) const {
        test::expectFailure(run, exitCode, words);
        EXPECT_EQ(run.out, "");
        EXPECT_EQ(test::namesIn(folder_ / "out"), Words());
    }
    fs::path side(const std::string& extension) const {
        return io::sidecarPath(rawlog_, extension);
    }

    test::TemporaryFolder folder_;
    fs::path seq_ = folder_ / "seq";
    fs::path rawlog_ = folder_ / "out" / "d.rawlog";
};

TEST_F(KittiTools, ThereAndBackIsBitExact) {
    auto odd = fewPoints(9, 4);
    odd[1] = std::numeric_limits<float>::quiet_NaN();
    odd[6] = std::numeric_limits<float>::infinity();
    odd[8] = -0.0F;
    odd[15] = std::numeric_limits<float>::quiet_NaN();
    test::writeFloats(seq_ / "velodyne" / "000002.bin", odd);
    writeText(seq_ / "velodyne" / "000003.bin", "");
    for (const Words& storage : {Words(), Words{"--embed"}}) {
        Words words = storage;
        words.emplace_back("--force");
        const auto there = toRawlog(words);
        ASSERT_EQ(there.exitCode, 0) << there.err;
        EXPECT_EQ(there.out, "");
        EXPECT_EQ(fs::exists(side("_Images")), storage.empty());
        const auto back = toKitti(folder_ / "back", {"--force"});
        ASSERT_EQ(back.exitCode, 0) << back.err;
        EXPECT_EQ(test::namesIn(folder_ / "back"), test::namesIn(seq_));
        for (const auto& name : test::namesIn(seq_))
            if (fs::is_regular_file(seq_ / name)) {
                EXPECT_EQ(test::readText(seq_ / name), test::readText(folder_ / "back" / name))
                    << name;
            }
    }
}

TEST_F(KittiTools, SideFilesHoldWhatWasThere) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    for (const std::string name : {"calib.txt", "times.txt", "poses.txt"})
        EXPECT_EQ(test::readText(side("." + name)), test::readText(seq_ / name));
    const auto meta = io::readDriveMeta(rawlog_);
    ASSERT_TRUE(meta);
    EXPECT_EQ(meta->source, "kitti-odometry");
    EXPECT_EQ(meta->sensorModel, "HDL-64E");
    EXPECT_TRUE(meta->motionCompensated);
    EXPECT_EQ(meta->verticalCorrectionDeg, 0.205);
    EXPECT_EQ(test::namesIn(folder_ / "out").size(), 1U + 1 + 5 + 4);  // no .partial files
}

TEST_F(KittiTools, StartAndCountPickTheRows) {
    ASSERT_EQ(toRawlog({"--start", "2", "--count", "2"}).exitCode, 0);
    for (const std::string name : {"times.txt", "poses.txt"}) {
        const auto all = test::linesOf(test::readText(seq_ / name));
        EXPECT_EQ(test::linesOf(test::readText(side("." + name))), Words({all[2], all[3]}));
    }
    io::ScanSource source(rawlog_, "", "", io::readDriveMeta(rawlog_)->epoch_s);
    for (const std::size_t scan : {2U, 3U}) {
        const auto found = source.next();
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->stamp_s, 0.1 * static_cast<double>(scan), 1e-7);
        EXPECT_EQ(found->points->getPointsBufferRef_x()[0], fewPoints(scan)[0]);
    }
    EXPECT_FALSE(source.next());
    // More than there is: to the end.
    ASSERT_EQ(toRawlog({"--start", "4", "--count", "9", "--force"}).exitCode, 0);
    EXPECT_EQ(test::linesOf(test::readText(side(".times.txt"))).size(), 1U);
}

TEST_F(KittiTools, MissingPartsAreWarnings) {
    fs::remove(seq_ / "times.txt");
    fs::remove(seq_ / "poses.txt");
    writeText(seq_ / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    const auto run = toRawlog();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("warning: '" + (seq_ / "calib.txt").string() + "' has no Tr"),
              std::string::npos)
        << run.err;
    EXPECT_NE(run.err.find("0.1 s apart"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(side(".poses.txt")));
    EXPECT_EQ(io::readTimes(side(".times.txt")), (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4}));
    fs::remove(seq_ / "calib.txt");
    EXPECT_EQ(toRawlog({"--force"}).exitCode, 0);
    EXPECT_FALSE(fs::exists(side(".calib.txt")));
}

TEST_F(KittiTools, RefusesWhatIsNoSequence) {
    const fs::path missing = folder_ / "none";
    const auto convert = [&](const fs::path& in) {
        return runTool("kitti2rawlog", {"-i", in, "-o", rawlog_});
    };
    expectRefused(convert(missing), 1, {missing, "not a folder"});
    expectRefused(convert(seq_ / "times.txt"), 1, {"not a folder"});
    fs::create_directories(missing);
    expectRefused(convert(missing), 1, {missing, "velodyne/"});
    fs::create_directories(missing / "velodyne");
    expectRefused(convert(missing), 1, {"no .bin file"});
    writeText(missing / "velodyne" / "first.bin", "");
    expectRefused(convert(missing), 1, {"first.bin", "number"});
}

TEST_F(KittiTools, RefusesACutScan) {
    for (const char* bytes : {"123456789012345", "12345678901234567"}) {
        writeText(seq_ / "velodyne" / "000003.bin", bytes);
        expectRefused(toRawlog(), 1, {"000003.bin", "multiple of 16"});
        expectRefused(toRawlog({"--embed"}), 1, {"000003.bin", "multiple of 16"});
    }
    EXPECT_EQ(toRawlog({"--count", "3"}).exitCode, 0);
}

TEST_F(KittiTools, RefusesTooFewRows) {
    writeText(seq_ / "times.txt", "0\n0.1\n0.2\n");
    expectRefused(toRawlog(), 1, {"times.txt", "3 rows", "--count 3"});
    EXPECT_EQ(toRawlog({"--count", "3"}).exitCode, 0);
    writeText(seq_ / "times.txt", "0\n0.1\n0.2\n0.3\n0.4\n");
    const auto poses = test::linesOf(test::readText(seq_ / "poses.txt"));
    writeText(seq_ / "poses.txt", poses[0] + "\n" + poses[1] + "\n");
    test::expectFailure(toRawlog({"--force"}), 1, {"poses.txt", "2 rows", "--count 2"});
    const auto late = toRawlog({"--force", "--start", "3"});
    test::expectFailure(late, 1, {"poses.txt", "2 rows"});
    EXPECT_EQ(late.err.find("--count 0"), std::string::npos) << late.err;
    EXPECT_EQ(toRawlog({"--force", "--count", "2"}).exitCode, 0);
}

TEST_F(KittiTools, RefusesBrokenTexts) {
    const auto with = [&](const std::string& name, const std::string& text) {
        const std::string good = test::readText(seq_ / name);
        writeText(seq_ / name, text);
        const auto run = toRawlog();
        writeText(seq_ / name, good);
        return run;
    };
    expectRefused(with("times.txt", "0\n0.1\nnoon\n0.3\n0.4\n"), 1, {"times.txt', line 3", "noon"});
    expectRefused(with("times.txt", "0\n0.2\n0.1\n0.3\n0.4\n"), 1, {"times.txt', line 3"});
    expectRefused(with("times.txt", ""), 1, {"times.txt", "empty"});
    expectRefused(with("poses.txt", "1 0 0 0 0 1 0 0 0 0 1\n"), 1, {"poses.txt', line 1", "12"});
    expectRefused(with("calib.txt", "Tr: 1 2 3\n"), 1, {"calib.txt', line 1", "12 numbers"});
    EXPECT_EQ(toRawlog().exitCode, 0);
}

TEST_F(KittiTools, RefusesABadCommandLine) {
    expectRefused(toRawlog({"--start", "-1"}), 2, {"-1"});
    expectRefused(toRawlog({"--count", "-3"}), 2, {"-3"});
    expectRefused(toRawlog({"--count", "1.5"}), 2, {"1.5"});
    expectRefused(toRawlog({"--start", "two"}), 2, {"two"});
    expectRefused(toRawlog({"--every", "2"}), 2, {"every"});
    expectRefused(runTool("kitti2rawlog", {"-i", seq_}), 2, {"output"});
    expectRefused(runTool("rawlog2kitti", {"-o", "x"}), 2, {"input"});
    expectRefused(toRawlog({"--start", "5"}), 1, {"5 scans", "--start 5"});
}

TEST_F(KittiTools, RefusesAnOutputThatItCannotWrite) {
    const auto into = [&](const fs::path& out) {
        return runTool("kitti2rawlog", {"-i", seq_, "-o", out});
    };
    expectRefused(into(folder_ / "out" / "d.log"), 1, {".rawlog"});
    expectRefused(into("/proc/d.rawlog"), 1, {"/proc/d.rawlog"});
    expectRefused(into(seq_ / "times.txt" / "d.rawlog"), 1, {"times.txt/d.rawlog"});
    expectRefused(into(folder_ / "none" / "d.rawlog"), 1, {"none/d.rawlog"});
}

TEST_F(KittiTools, ReplacesOnlyWithForce) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    writeText(side(".faults.tsv"), "of a synthetic drive\n");
    const auto before = test::namesIn(folder_ / "out");
    const std::string bytes = test::readText(rawlog_);
    test::expectFailure(toRawlog({"--count", "2"}), 1, {rawlog_, "--force"});
    EXPECT_EQ(test::namesIn(folder_ / "out"), before);
    EXPECT_EQ(test::readText(rawlog_), bytes);
    // A side file alone is reason enough.
    fs::remove(rawlog_);
    test::expectFailure(toRawlog(), 1, {"--force"});

    fs::remove(seq_ / "poses.txt");
    fs::remove(seq_ / "calib.txt");
    ASSERT_EQ(toRawlog({"--embed", "--force"}).exitCode, 0);
    EXPECT_EQ(test::namesIn(folder_ / "out"), Words({"d.meta.yaml", "d.rawlog", "d.times.txt"}));

    fs::remove(rawlog_);
    fs::create_directory(rawlog_);
    test::expectFailure(toRawlog({"--force"}), 1, {rawlog_, "is a folder"});
    EXPECT_TRUE(fs::exists(side(".times.txt")));
}

TEST_F(KittiTools, AnInterruptLeavesNothing) {
    for (std::size_t i = 5; i < 3000; ++i)
        test::writeFloats(seq_ / "velodyne" / test::scanName(i), fewPoints(i));
    for (const char* name : {"times.txt", "poses.txt"}) fs::remove(seq_ / name);
    const auto run = runTool("kitti2rawlog", {"-i", seq_, "-o", rawlog_}, "converting 300/3000");
    EXPECT_EQ(run.exitCode, 130) << run.err;
    EXPECT_EQ(test::namesIn(folder_ / "out"), Words());
}

TEST_F(KittiTools, FindsThePosesOfKittisOwnLayout) {
    const fs::path sequence = folder_ / "dataset" / "sequences" / "07";
    test::writeSequence(sequence, fewScans(3));
    fs::create_directory(folder_ / "dataset" / "poses");
    fs::rename(sequence / "poses.txt", folder_ / "dataset" / "poses" / "07.txt");
    const std::string poses = test::readText(folder_ / "dataset" / "poses" / "07.txt");
    for (const std::string name : {"", "/", "/.", "/../07/"}) {
        const auto run =
            runTool("kitti2rawlog", {"-i", sequence.string() + name, "-o", rawlog_, "--force"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        ASSERT_TRUE(fs::exists(side(".poses.txt"))) << name;
        EXPECT_EQ(test::readText(side(".poses.txt")), poses);
    }
}

TEST_F(KittiTools, RawlogEditCountsAllScans) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    const auto info = runTool("rawlog-edit", {"--info", "-i", rawlog_});
    if (info.exitCode == 127) {
        if (test::dataIsRequired()) FAIL() << "rawlog-edit (mrpt-apps) is not installed";
        GTEST_SKIP() << "rawlog-edit (mrpt-apps) is not installed";
    }
    EXPECT_EQ(info.exitCode, 0) << info.err;
    EXPECT_NE(info.out.find("velodyne"), std::string::npos) << info.out;
    bool counted = false;
    for (const auto& line : test::linesOf(info.out))
        counted = counted || (line.find("velodyne") != std::string::npos &&
                              line.find("5") != std::string::npos);
    EXPECT_TRUE(counted) << info.out;
}

TEST_F(KittiTools, TimesComeBackWithoutTheirFile) {
    ASSERT_EQ(toRawlog().exitCode, 0);
    fs::remove(side(".times.txt"));
    ASSERT_EQ(toKitti(folder_ / "back").exitCode, 0);
    const auto back = io::readTimes(folder_ / "back" / "times.txt");
    ASSERT_EQ(back.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(back[i], 0.1 * static_cast<double>(i), 1e-7);
}

TEST_F(KittiTools, Rawlog2kittiRefusesAndLeavesNothing) {
    ASSERT_EQ(toRawlog({"--embed"}).exitCode, 0);
    const fs::path target = folder_ / "back";
    const auto expectNothing = [&](const test::CommandResult& run, const Words& words) {
        test::expectFailure(run, 1, words);
        EXPECT_EQ(run.out, "");
        EXPECT_FALSE(fs::exists(target));
        EXPECT_FALSE(fs::exists(folder_ / ".partial-back"));
    };
    expectNothing(runTool("rawlog2kitti", {"-i", folder_ / "none.rawlog", "-o", target}),
                  {"none.rawlog"});
    expectNothing(runTool("rawlog2kitti", {"-i", seq_ / "times.txt", "-o", target}),
                  {"times.txt", "not a rawlog"});
    expectNothing(toKitti(target, {"--sensor-label", "ouster"}), {"no LiDAR scans"});
    test::expectFailure(toKitti("/proc/back"), 1, {"/proc/back"});
    test::expectFailure(toKitti(seq_ / "times.txt" / "back"), 1, {"times.txt/back"});
    const std::string bytes = test::readText(rawlog_);
    writeText(rawlog_, bytes.substr(0, bytes.size() * 2 / 3));
    expectNothing(toKitti(target), {"cut off"});
    writeText(rawlog_, "");
    expectNothing(toKitti(target), {"empty"});
    writeText(side(".meta.yaml"), "epoch_unix_s: noon\n");
    expectNothing(toKitti(target), {"meta.yaml"});
}

TEST_F(KittiTools, Rawlog2kittiReplacesNothingButTheSequence) {
    ASSERT_EQ(toRawlog({"--count", "2"}).exitCode, 0);
    const fs::path target = folder_ / "back";
    test::writeSequence(target, fewScans(4));
    writeText(target / "mine.txt", "mine");
    test::expectFailure(toKitti(target), 1, {target, "--force"});
    fs::remove(side(".calib.txt"));
    ASSERT_EQ(toKitti(target, {"--force"}).exitCode, 0);
    EXPECT_EQ(test::namesIn(target), Words({"mine.txt", "poses.txt", "times.txt", "velodyne",
                                            "velodyne/000000.bin", "velodyne/000001.bin"}));
    EXPECT_EQ(test::readText(target / "mine.txt"), "mine");
    writeText(folder_ / "file", "mine");
    test::expectFailure(toKitti(folder_ / "file", {"--force"}), 1, {"no folder"});
    EXPECT_EQ(test::readText(folder_ / "file"), "mine");
}

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
    static CPose3D imuPose(std::size_t i) {
        const auto n = static_cast<double>(i);
        return CPose3D::FromXYZYawPitchRoll(1.2 * n, 0.3 * n * n, 0.05 * n, 0.3 + 0.1 * n, 0.01 * n,
                                            -0.02 * n);
    }

    /** The inverse of KITTI's Mercator. */
    static std::string oxtsRow(std::size_t i) {
        const CPose3D pose = imuPose(i);
        const double radius = 6378137.0, scale = std::cos(kLat * M_PI / 180) * radius;
        const double north = scale * std::log(std::tan(M_PI * (90 + kLat) / 360)) + pose.y();
        const double lat = std::atan(std::exp(north / scale)) * 360 / M_PI - 90;
        const double lon = kLon + pose.x() / scale * 180 / M_PI;
        char row[256];
        std::snprintf(row, sizeof(row), "%.15g %.15g %.15g %.15g %.15g %.15g 0 0 0\n", lat, lon,
                      116.0 + pose.z(), pose.roll(), pose.pitch(), pose.yaw());
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
    const auto Tr = calibration.Tr.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>();
    EXPECT_LT((Tr.asEigen() - wanted).cwiseAbs().maxCoeff(), 1e-9);

    const std::vector<std::size_t> numbers = {0, 1, 3, 4, 5};
    const auto imuToCam = calibration.Tr + CPose3D::FromTranslation(-0.81, 0.32, -0.8);
    const auto poses = io::readTrajectory(folder_ / "d.poses.txt").poses;
    ASSERT_EQ(poses.size(), numbers.size());
    EXPECT_LT(poses[0].norm(), 1e-6);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const CPose3D truth = imuToCam + (imuPose(numbers[i]) - imuPose(0)) + (-imuToCam);
        EXPECT_LT((poses[i] - truth).norm(), 1e-3) << i;
        EXPECT_LT(poses[i].distanceEuclidean6D(truth), 1e-3) << i;
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
    EXPECT_LT(poses[0].norm(), 1e-6);
    EXPECT_NEAR(poses[1].norm(), (imuPose(4) - imuPose(3)).norm(), 0.2);
}

TEST_F(KittiRaw, MissingPartsAreWarningsAndBrokenOnesErrors) {
    fs::remove(drive_ / "oxts" / "data" / "0000000003.txt");
    auto run = convert();
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("warning: '" + (drive_ / "oxts/data/0000000003.txt").string()),
              std::string::npos)
        << run.err;
    EXPECT_FALSE(fs::exists(folder_ / "d.poses.txt"));
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
