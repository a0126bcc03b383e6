#include <gtest/gtest.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <sys/stat.h>

#include "delio/recordings/scan_reader.h"
#include "files/input_file.h"
#include "rawlog_files.h"

namespace delio::rawlog_test {
namespace {
using test::TemporaryFolder;

std::string refusal(const std::string& path) {
    try {
        io::openScans(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}
}  // namespace

TEST(OpenScans, RefusesWhatIsNoRecording) {
    const TemporaryFolder folder;
    test::writeText(folder / "a.pcd", "# .PCD v0.7\n");
    test::writeText(folder / "a.osf", "\x01\x02\x03");
    test::writeText(folder / "old.bag", "#ROSBAG V1.2\n");
    test::writeText(folder / "empty.bag", "");
    EXPECT_NE(refusal(folder / "none").find("no such file or folder"), std::string::npos);
    EXPECT_NE(refusal(folder / "a.pcd").find("give the folder"), std::string::npos);
    EXPECT_NE(refusal(folder / "a.osf").find("is not an OSF file"), std::string::npos);
    EXPECT_NE(refusal(folder / "old.bag").find("a version other than 2.0"), std::string::npos);
    EXPECT_NE(refusal(folder / "empty.bag").find("is empty"), std::string::npos);
    std::filesystem::create_directory(folder / "empty");
    EXPECT_NE(refusal(folder / "empty").find("no scans"), std::string::npos);
    EXPECT_NE(refusal("/dev/null"), "");
}

// Nobody writes into these pipes: to open one would be to wait for ever.
TEST(OpenScans, PipesAreNotWaitedFor) {
    const TemporaryFolder folder;
    ASSERT_EQ(mkfifo((folder / "d.rawlog").c_str(), 0600), 0);
    EXPECT_NE(refusal(folder / "d.rawlog").find("standard input"), std::string::npos);
    test::writeText(folder / "e.rawlog", "something");
    ASSERT_EQ(mkfifo((folder / "e.meta.yaml").c_str(), 0600), 0);
    EXPECT_NE(refusal(folder / "e.rawlog").find("not a regular file"), std::string::npos);
    ASSERT_EQ(mkfifo((folder / "e.calib.txt").c_str(), 0600), 0);
    EXPECT_THROW(io::sideFile((folder / "e.calib.txt").string()), Error);
    EXPECT_TRUE(io::sideFile((folder / "none.txt").string()).text.empty());
}

TEST(OpenScans, NamesOfDrives) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "00.d");
    EXPECT_EQ(io::nameOfDrive(folder / "a.rawlog"), "a");
    EXPECT_EQ(io::nameOfDrive(folder / "00.d"), "00.d");
    EXPECT_EQ(io::nameOfDrive((folder / "00.d").string() + "/"), "00.d");
    EXPECT_EQ(io::nameOfDrive("-"), "stdin");
    EXPECT_EQ(io::nameOfDrive(folder / "a\nb.rawlog"), "a?b");
    EXPECT_THROW(io::nameOfDrive(folder / "...rawlog"), Error);
    EXPECT_THROW(io::nameOfDrive("/"), Error);
}

TEST(RawlogReader, SensorsWithoutLabelsAreKeptApart) {
    const TemporaryFolder folder;
    auto moved = cloudObservation(1, "");
    moved->sensorPose = mrpt::poses::CPose3D(5, 0, 0, 0, 0, 0);
    writeRawlog(folder / "a.rawlog", {cloudObservation(0, ""), moved, cloudObservation(2, "other"),
                                      cloudObservation(3, "")});
    const auto xOf = [](const Scan& scan) { return scan.points->getPointsBufferRef_x().front(); };
    io::RawlogReader first(folder / "a.rawlog");
    EXPECT_EQ(xOf(*first.next()), 0);
    EXPECT_EQ(xOf(*first.next()), 3);
    EXPECT_FALSE(first.next());
    EXPECT_EQ(first.label(), "");
    EXPECT_EQ(first.otherLabels(), (std::set<std::string>{"other", "unlabelled-2"}));
    io::RawlogReader second(folder / "a.rawlog", "unlabelled-2");
    EXPECT_EQ(xOf(*second.next()), 1);
    EXPECT_FALSE(second.next());
}

TEST(RawlogReader, AClassThatIsNotKnownIsNamed) {
    const TemporaryFolder folder;
    writeRawlog(folder / "a.rawlog", {cloudObservation(0), cloudObservation(1)});
    std::string bytes = test::readText(folder / "a.rawlog");
    const std::string known = "CObservationPointCloud";
    const auto second = bytes.find(known, bytes.find(known) + 1);
    bytes.replace(second, known.size(), "CObservationOfTomorrow");
    test::writeText(folder / "a.rawlog", bytes);
    io::RawlogReader reader(folder / "a.rawlog");
    std::size_t scans = 0;
    const std::string fault = faultOf(reader, scans);
    EXPECT_EQ(scans, 1U);
    EXPECT_NE(fault.find("CObservationOfTomorrow"), std::string::npos) << fault;
}

TEST(RawlogReader, DepthScansInExternalFiles) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder / "a_Images");
    mrpt::obs::CObservation3DRangeScan depth;
    depth.sensorLabel = "kinect";
    depth.timestamp = mrpt::Clock::fromDouble(1000);
    depth.hasPoints3D = true;
    depth.resizePoints3DVectors(3);
    for (std::size_t i = 0; i < 3; ++i) {
        depth.points3D_x[i] = static_cast<float>(i);
        depth.points3D_y[i] = 2;
        depth.points3D_z[i] = 3;
    }
    depth.points3D_convertToExternalStorage("p.bin", (folder / "a_Images").string() + "/");
    writeRawlog(folder / "a.rawlog", {std::make_shared<mrpt::obs::CObservation3DRangeScan>(depth)});
    io::RawlogReader reader(folder / "a.rawlog");
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 3U);
    EXPECT_EQ(scan->points->getPointsBufferRef_x()[2], 2);

    std::filesystem::rename(folder / "a_Images", folder / "elsewhere");
    io::RawlogReader lost(folder / "a.rawlog");
    std::size_t scans = 0;
    EXPECT_NE(faultOf(lost, scans).find("'p.bin' is in none of the folders tried"),
              std::string::npos);
    EXPECT_TRUE(io::RawlogReader(folder / "a.rawlog", "", folder / "elsewhere").next());
    const std::string whole = test::readText(folder / "elsewhere" / "p.bin");
    test::writeText(folder / "elsewhere" / "p.bin", whole.substr(0, whole.size() / 2));
    io::RawlogReader cut(folder / "a.rawlog", "", folder / "elsewhere");
    EXPECT_NE(faultOf(cut, scans).find("cannot read its points"), std::string::npos);
}
}  // namespace delio::rawlog_test
