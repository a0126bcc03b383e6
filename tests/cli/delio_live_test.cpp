// delio-live: MRPT's driver of a Velodyne, fed by a pcap, through a pipe into delio-slam.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio_slam_fixture.h"
#include "pcap_writer.h"
#include "tools.h"

namespace {
using namespace delio;
using test::readText;
using test::runTool;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

class DelioLive : public test::DelioSlam {
 protected:
    void SetUp() override {
        if (std::find(test::kTools.begin(), test::kTools.end(), "delio-live") == test::kTools.end())
            GTEST_SKIP() << "built without mrpt-hwdrivers";
    }

    /** Of a VLP-16 that was driven, 14 turns. */
    void writePcap() const {
        const std::string all =
            readText((test::dataFolder() / "mrpt/vlp16_packets_1206.bin").string());
        test::PcapWriter pcap;
        for (std::size_t at = 0; at + 1206 <= all.size(); at += 1206) {
            const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
            pcap.add(test::Bytes(begin, begin + 1206), 1e9 + 1e-6 * static_cast<double>(at));
        }
        pcap.write(pcap_);
    }

    /** Settings as those of rawlog-grabber. `repeats`: the drive never ends. */
    void writeSettings(const std::string& more = "", bool repeats = false) const {
        test::writeText(ini_,
                        "[global]\nrawlog_prefix = unused\n[camera]\n"
                        "rawlog-grabber-ignore = true\n[lidar]\ndriver = CVelodyneScanner\n"
                        "process_rate = 10000\nmodel = VLP16\nsensorLabel = lidar\n"
                        "pcap_read_full_scan_delay_ms = 100\npcap_input = " +
                            pcap_ + "\npcap_read_once = " + (repeats ? "false" : "true") + "\n" +
                            more);
    }

    test::CommandResult live(const std::string& output, const Words& more = {}) const {
        return runTool("delio-live", Words{"-i", ini_, "-o", output} + more);
    }

    static test::CommandResult shell(const std::string& line) {
        return runTool("bash", {"-c", "set -o pipefail; " + line});
    }

    /** Points of the scans that were used, their mean. */
    static double pointsOf(const fs::path& folder) {
        const auto column = test::csvColumns(folder / "scans.csv")["points"];
        double sum = 0;
        for (const auto& points : column) sum += std::stod(points);
        return sum / static_cast<double>(column.size());
    }
    static Eigen::Vector3d endOf(const fs::path& folder) {
        return io::readTrajectory(folder / "trajectory_kitti.txt").poses.back().translation();
    }

    const std::string ini_ = folder_ / "sensors.ini", pcap_ = folder_ / "vlp16.pcap",
                      made_ = folder_ / "made.rawlog";
    const std::string tool_ = "'" + test::toolPath("delio-live") + "' -i '" + ini_ + "' -o -";
};

TEST_F(DelioLive, ADriverAndAPipe) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    writePcap();
    writeSettings();
    const auto run = shell(tool_ + " | tee '" + made_ + "' | '" + test::toolPath("delio-slam") +
                           "' -i - --no-map -o '" + out_.string() + "'");
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("sensor 'lidar' gives no more data"), std::string::npos) << run.err;
    EXPECT_GE(rows("trajectory_kitti.txt"), 11U);
    // The same as from a file, and nearly as without MRPT's driver.
    const fs::path again = folder_ / "again", direct = folder_ / "direct";
    ASSERT_EQ(runTool("delio-slam", {"-i", made_, "-o", again, "--no-map"}).exitCode, 0);
    for (const char* const name : {"trajectory_kitti.txt", "trajectory_tum.txt", "posegraph.g2o"})
        EXPECT_EQ(readText(again / name), readText(out_ / name)) << name;
    ASSERT_EQ(runTool("delio-slam", {"-i", pcap_, "-o", direct, "--no-map"}).exitCode, 0);
    EXPECT_NEAR(pointsOf(out_), pointsOf(direct), 0.05 * pointsOf(direct));
    EXPECT_LT((endOf(out_) - endOf(direct)).norm(), 0.1);  // metres
}

TEST_F(DelioLive, ASignalEndsTheDriveAndItsRawlogIsWhole) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    writePcap();
    writeSettings("", true);
    test::RunningTool run("delio-live", {"-i", ini_, "-o", made_});
    std::error_code none;
    while (!run.hasEnded() && !(fs::file_size(made_, none) > 800'000 && !none))
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    run.send(SIGTERM);
    const auto ended = run.wait();
    EXPECT_EQ(ended.exitCode, 0) << ended.err;
    EXPECT_EQ(ended.out, "");  // what drivers print goes to stderr
    io::RawlogReader reader(made_);
    std::size_t scans = 0;
    while (reader.next()) ++scans;  // throws where it is cut off
    EXPECT_GE(scans, 6U);
    EXPECT_EQ(reader.label(), "lidar_SCAN");
}

TEST_F(DelioLive, EndsWithItsReader) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    writePcap();
    writeSettings("", true);
    const auto run = shell(tool_ + " | head -c 300000 | wc -c");
    EXPECT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.out, "300000\n");
}

TEST_F(DelioLive, SaysWhatIsWrongWithTheSettings) {
    const auto refuses = [&](const std::string& settings, const Words& words) {
        test::writeText(ini_, settings);
        const auto run = live(made_);
        EXPECT_EQ(run.exitCode, 1) << run.err;
        for (const auto& word : words) EXPECT_NE(run.err.find(word), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(made_));
    };
    refuses("", {ini_, "no section of a sensor"});
    refuses("[global]\nrawlog_prefix = x\n", {"no section of a sensor"});
    refuses("[a]\nprocess_rate = 10\n", {"sensor 'a'", "no 'driver'"});
    refuses("[a]\ndriver = CNoSuchLidar\nprocess_rate = 10\n", {"no driver 'CNoSuchLidar'"});
    refuses("[a]\ndriver = CVelodyneScanner\n", {"sensor 'a'", "process_rate"});
    refuses("[a]\ndriver = CVelodyneScanner\nprocess_rate = 10\npcap_input = no.pcap\n",
            {"sensor 'a'", "no.pcap"});
    test::expectFailure(runTool("delio-live", {"-i", folder_ / "no.ini", "-o", made_}), 1,
                        {"no.ini", "no such file"});
}

TEST_F(DelioLive, OverwritesOnlyWhatItMay) {
    writeSettings();
    test::expectFailure(live(ini_, {"--force"}), 1, {ini_});
    test::writeText(made_, "mine");
    test::expectFailure(live(made_), 1, {made_, "--force"});
    EXPECT_EQ(readText(made_), "mine");
}
}  // namespace
