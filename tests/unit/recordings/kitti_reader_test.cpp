// KITTI's folders in place: the same as by way of a rawlog.
#include "recordings/kitti_folder.h"

#include <limits>

#include "cloud_files.h"
#include "comma_locale.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/rawlog_reader.h"
#include "recordings/sources.h"
#include "same_scans.h"
#include "toy_drive.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;
using cloud_test::errorOf;
using cloud_test::expectError;
using test::writeText;

std::vector<test::Floats> fewScans(std::size_t count) {
    std::vector<test::Floats> scans(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 4 * (7 + i); ++k)
            scans[i].push_back(0.1F * static_cast<float>(k) - 3.3F * static_cast<float>(i));
    scans[1][5] = std::numeric_limits<float>::quiet_NaN();
    return scans;
}

/** The rawlog that kitti2rawlog makes of a drive. */
std::string rawlogOf(const fs::path& folder, const fs::path& rawlog) {
    const auto drive = io::openKittiDrive(folder, 0, 0);
    io::RawlogWriter writer(rawlog.string(), "velodyne", false, true);
    for (std::size_t i = 0; i < drive.scans.size(); ++i)
        writer.addLinked(drive.times_s[i], drive.meta.epoch_s, drive.scans[i].string());
    std::string poses;
    for (const auto& row : drive.poseRows) poses += row + "\n";
    writer.finish(drive.meta, "", drive.calibText, poses);
    return rawlog.string();
}

class KittiReader : public testing::Test {
 protected:
    void SetUp() override { test::writeSequence(sequence_, fewScans(4)); }

    std::string errorOfOpening(const fs::path& folder) const {
        return errorOf([&] { io::KittiReader{folder}; });
    }

    test::TemporaryFolder folder_;
    const fs::path sequence_ = folder_ / "03";
};

TEST_F(KittiReader, SequenceIsTheSameAsItsRawlog) {
    writeText(sequence_ / "times.txt", "0\n1.037120e-01\n2.0744021e-01\n3.1e-01\n");
    for (const fs::path& path : {sequence_, sequence_ / "velodyne", sequence_ / "velodyne" / ""}) {
        ASSERT_TRUE(io::isKittiFolder(path));
        const auto reader = io::openKittiFolder({path.string(), "", "", ""});
        io::RawlogReader rawlog(rawlogOf(sequence_, folder_ / "d.rawlog"));
        EXPECT_EQ(test::expectSameScans(*reader, rawlog), 4U);
        test::expectSameDrive(*reader, rawlog);
    }
}

// A drive of two scans, of which the second is missing: rows are found by the number.
TEST_F(KittiReader, RawDriveIsTheSameAsItsRawlog) {
    const fs::path date = folder_ / "2011_09_26", drive = date / "drive_0001_sync";
    const fs::path scans = drive / "velodyne_points" / "data";
    fs::create_directories(scans);
    fs::create_directories(drive / "oxts" / "data");
    for (const std::string number : {"0000000000", "0000000002"}) {
        test::writeFloats(scans / (number + ".bin"), fewScans(3)[2]);
        writeText(drive / "oxts" / "data" / (number + ".txt"), "49.1 8.4 116 0.01 0.02 1.3 0 0\n");
    }
    writeText(drive / "velodyne_points" / "timestamps.txt",
              "2011-09-26 13:02:25.951199337\n\n2011-09-26 13:02:26.157989654\n");
    const std::string rigid = "R: 0 -1 0 0 0 -1 1 0 0\nT: 0.1 0.2 0.3\n";
    writeText(date / "calib_velo_to_cam.txt", "calib_time: 15-Mar-2012\n" + rigid);
    writeText(date / "calib_imu_to_velo.txt", rigid);
    writeText(date / "calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n");
    for (const fs::path& path : {drive, drive / "velodyne_points", scans}) {
        ASSERT_TRUE(io::isKittiFolder(path));
        io::KittiReader reader(path);
        EXPECT_EQ(reader.recording().kind, "KITTI raw");
        EXPECT_EQ(reader.recording().motionCompensated, std::optional<bool>(false));
        io::RawlogReader rawlog(rawlogOf(drive, folder_ / "d.rawlog"));
        EXPECT_EQ(test::expectSameScans(reader, rawlog), 2U);
        test::expectSameDrive(reader, rawlog);
        EXPECT_EQ(test::linesOf(reader.truth().text).size(), 2U);
    }
}

/** Calibration and OXTS have fractions, which a locale may write with a comma. */
TEST_F(KittiReader, ARawDriveIsTheSameInAnyLocale) {
    const fs::path date = folder_ / "2011_09_26", drive = date / "drive_0001_sync";
    fs::create_directories(drive / "velodyne_points" / "data");
    fs::create_directories(drive / "oxts" / "data");
    for (const std::string number : {"0000000000", "0000000001"}) {
        test::writeFloats(drive / "velodyne_points" / "data" / (number + ".bin"), fewScans(3)[2]);
        writeText(drive / "oxts" / "data" / (number + ".txt"),
                  "49.000" + number + " 8.4 116.5 0.01 0.02 1.3 0 0\n");
    }
    writeText(drive / "velodyne_points" / "timestamps.txt",
              "2011-09-26 13:02:25.951199337\n2011-09-26 13:02:26.157989654\n");
    for (const char* name : {"calib_velo_to_cam.txt", "calib_imu_to_velo.txt"})
        writeText(date / name, "R: 0 -1 0 0 0 -1 1 0 0\nT: 0.1 0.2 0.3\n");
    writeText(date / "calib_cam_to_cam.txt", "R_rect_00: 0.8 0 0.6 0 1 0 -0.6 0 0.8\n");
    const auto before = io::openKittiDrive(drive, 0, 0);
    EXPECT_EQ(before.poseRows.size(), 2U);
    const test::CommaLocale locale;
    const auto after = io::openKittiDrive(drive, 0, 0);
    EXPECT_EQ(after.calibText, before.calibText);
    EXPECT_EQ(after.poseRows, before.poseRows);
    EXPECT_EQ(after.times_s, before.times_s);
}

TEST_F(KittiReader, SaysWhatItIs) {
    io::KittiReader reader(sequence_);
    const auto recording = reader.recording();
    EXPECT_EQ(recording.kind, "KITTI odometry");
    EXPECT_EQ(recording.sensor, "HDL-64E");
    EXPECT_EQ(recording.motionCompensated, std::optional<bool>(true));
    EXPECT_EQ(recording.scans, std::optional<std::size_t>(4));
    EXPECT_FALSE(recording.pointTimes);
    EXPECT_EQ(reader.calibration().name, (sequence_ / "calib.txt").string());
    EXPECT_EQ(reader.truth().name, (sequence_ / "poses.txt").string());
    EXPECT_TRUE(reader.warnings().empty());
    EXPECT_EQ(reader.fraction(), std::optional<double>(0));
    ASSERT_TRUE(reader.skip());
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->index, 1U);
    EXPECT_EQ(reader.fraction(), std::optional<double>(0.5));
    EXPECT_TRUE(reader.skip() && reader.skip());
    EXPECT_FALSE(reader.skip());
    EXPECT_FALSE(reader.next());
}

// KITTI's vertical angles are off; those of a sensor whose scans came into its format are not.
TEST_F(KittiReader, OnlyKittisOwnSensorIsCorrected) {
    const auto metaWith = [&](const std::string& calib) {
        writeText(sequence_ / "calib.txt", calib);
        return *io::KittiReader(sequence_).meta();
    };
    const std::string Tr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
    const auto kittis = metaWith("P0: 1 0 0 0 0 1 0 0 0 0 1 0\n" + Tr), other = metaWith(Tr);
    EXPECT_EQ(kittis.sensorModel, "HDL-64E");
    EXPECT_EQ(kittis.verticalCorrectionDeg, 0.205);
    EXPECT_EQ(other.sensorModel, "unknown");
    EXPECT_EQ(other.verticalCorrectionDeg, 0);
    EXPECT_TRUE(io::KittiReader(sequence_).warnings().empty());
    fs::remove(sequence_ / "calib.txt");
    EXPECT_EQ(io::KittiReader(sequence_).meta()->verticalCorrectionDeg, 0);
    const auto warnings = io::KittiReader(sequence_).warnings();
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("scan.vertical_correction_deg=0.205"), std::string::npos);
    EXPECT_EQ(io::KittiReader(sequence_).recording().sensor, "");
}

TEST_F(KittiReader, MissingPartsAreWarnings) {
    for (const char* name : {"times.txt", "poses.txt", "calib.txt"}) fs::remove(sequence_ / name);
    io::KittiReader reader(sequence_);
    EXPECT_EQ(reader.warnings().size(), 2U);
    EXPECT_EQ(reader.calibration().text, "");
    EXPECT_EQ(reader.truth().text, "");
    EXPECT_EQ(reader.truth().name, (sequence_ / "poses.txt").string());
    ASSERT_TRUE(reader.skip());
    EXPECT_EQ(reader.next()->stamp_s, 0.1);
    // A folder `velodyne` of any drive is none of KITTI's.
    EXPECT_FALSE(io::isKittiFolder(sequence_ / "velodyne"));
    EXPECT_FALSE(io::isKittiFolder(folder_.path()));
    EXPECT_FALSE(io::isKittiFolder(folder_ / "none"));
}

TEST_F(KittiReader, NominalTimesAreSaid) {
    EXPECT_EQ(io::KittiReader{sequence_}.recording().kind, "KITTI odometry");
    fs::remove(sequence_ / "times.txt");
    EXPECT_EQ(io::KittiReader{sequence_}.recording().kind, "KITTI odometry, nominal times");
}

// KITTI's own scans are de-skewed; those of another sensor in its format need not be.
TEST_F(KittiReader, ThatScansAreDeskewedIsAssumedOfOtherSensors) {
    const auto lineWith = [&](const std::string& calib) {
        writeText(sequence_ / "calib.txt", calib);
        return describe(io::KittiReader(sequence_).recording());
    };
    const std::string Tr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
    EXPECT_NE(lineWith(Tr).find("de-skewed by the recorder (assumed)"), std::string::npos);
    EXPECT_EQ(lineWith("P0: 1 0 0 0 0 1 0 0 0 0 1 0\n" + Tr).find("assumed"), std::string::npos);
}

TEST_F(KittiReader, TimesThatDoNotRiseAreNoFault) {
    writeText(sequence_ / "times.txt", "0\n0.1\n0.1\n0.3\n");
    const auto reader = io::openScans(sequence_.string());
    std::vector<std::size_t> scans;
    while (const auto scan = reader->next()) scans.push_back(scan->index);
    EXPECT_EQ(scans, (std::vector<std::size_t>{0, 1, 3}));
}

TEST_F(KittiReader, RefusesADamagedScan) {
    const fs::path cut = sequence_ / "velodyne" / "000002.bin";
    writeText(cut, "123456789012345");
    io::KittiReader reader(sequence_);
    EXPECT_TRUE(reader.next() && reader.next());
    expectError(errorOf([&] { reader.next(); }), {cut.string(), "multiple of 16"});
    EXPECT_FALSE(reader.next());
    EXPECT_FALSE(reader.skip());
    fs::remove(cut);
    fs::create_directory(cut);
    io::KittiReader other(sequence_);
    EXPECT_TRUE(other.skip() && other.skip());
    expectError(errorOf([&] { other.next(); }), {cut.string()});
    // It may be passed over.
    io::KittiReader third(sequence_);
    EXPECT_TRUE(third.skip() && third.skip() && third.skip());
    EXPECT_TRUE(third.next());
}

TEST_F(KittiReader, RefusesABrokenDrive) {
    writeText(sequence_ / "times.txt", "0\n0.1\n");
    expectError(errorOfOpening(sequence_), {"times.txt", "2 rows"});
    writeText(sequence_ / "times.txt", "0\n0.1\nnoon\n0.3\n");
    expectError(errorOfOpening(sequence_), {"times.txt", "noon"});
    fs::remove(sequence_ / "times.txt");
    writeText(sequence_ / "calib.txt", "Tr: 1 2 3\n");
    expectError(errorOfOpening(sequence_), {"calib.txt"});
    expectError(errorOfOpening(folder_ / "none"), {"none"});
}
}  // namespace
