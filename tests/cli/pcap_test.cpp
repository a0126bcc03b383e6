// share/doc/compatibility.md, done: a Velodyne pcap through MRPT's rawlog-grabber to a trajectory.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "scan_columns.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(Pcap, GrabbedByMrptAndRead) {
    DELIO_NEED_DATA("mrpt/sample_velodyne_vlp16_gps.pcap");
    if (test::runTool("sh", {"-c", "command -v rawlog-grabber"}).exitCode != 0) {
        if (test::dataIsRequired()) FAIL() << "rawlog-grabber (mrpt-apps) is not installed";
        GTEST_SKIP() << "rawlog-grabber is not installed";
    }
    const test::TemporaryFolder folder;
    const auto pcap =
        std::filesystem::absolute(test::dataFolder() / "mrpt/sample_velodyne_vlp16_gps.pcap");
    test::writeText(folder / "vlp16.ini",
                    "[global]\nrawlog_prefix = " + (folder / "vlp16").string() +
                        "\ntime_between_launches = 100\nuse_sensoryframes = false\n"
                        "GRABBER_PERIOD_MS = 100\nrawlog_GZ_compress_level = 0\n"
                        "[Velodyne]\ndriver = CVelodyneScanner\nprocess_rate = 1000\n"
                        "sensorLabel = velodyne\nmodel = VLP16\npcap_input = " +
                        pcap.string() +
                        "\npcap_read_once = true\npcap_read_fast = true\n"
                        "pose_x = 0\npose_y = 0\npose_z = 0\n"
                        "pose_yaw = 0\npose_pitch = 0\npose_roll = 0\n");
    const auto grabbed = test::runTool(
        "sh", {"-c", "sleep 6 | rawlog-grabber '" + (folder / "vlp16.ini").string() + "'"});
    std::string rawlog;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        if (entry.path().extension() == ".rawlog") rawlog = entry.path().string();
    ASSERT_FALSE(rawlog.empty()) << grabbed.out << grabbed.err;

    // The sample is of a room: three scans of a sensor that stands still.
    const std::string out = folder / "out";
    const auto slam = test::runTool("delio-slam", {"-i", rawlog, "-o", out, "--no-map"});
    ASSERT_EQ(slam.exitCode, 0) << slam.err;
    const auto trajectory = io::readTrajectory(out + "/trajectory_kitti.txt");
    ASSERT_EQ(trajectory.poses.size(), 3U);
    for (const auto& pose : trajectory.poses) EXPECT_LT(pose.translation().norm(), 0.01);
    // Half of a VLP-16's returns would be 6900 a scan.
    const auto scans = test::csvColumns(out + "/scans.csv");
    ASSERT_EQ(scans.at("points").size(), 3U);
    for (const auto& points : scans.at("points")) EXPECT_GT(std::stoi(points), 13000);
    const std::vector<std::string> none = {"0", "0", "0"};
    EXPECT_EQ(scans.at("predicted"), none);
}
}  // namespace
