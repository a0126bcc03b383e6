// delio-slam -i udp://: packets over loopback. However many of them come, the recording gives the
// same results.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <csignal>
#include <cstring>
#include <random>

#include "delio_slam_fixture.h"
#include "udp_sender.h"

namespace {
using namespace delio;
using test::Bytes;
using test::readText;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;

class Live : public test::DelioSlam {
 protected:
    /** A VLP-16 that was driven, 14 turns. */
    static std::vector<Bytes> vlp16() {
        const std::string all =
            readText((test::dataFolder() / "mrpt/vlp16_packets_1206.bin").string());
        std::vector<Bytes> packets;
        for (std::size_t at = 0; at + 1206 <= all.size(); at += 1206)
            packets.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(at),
                                 all.begin() + static_cast<std::ptrdiff_t>(at + 1206));
        return packets;
    }

    Words words(const Words& more = {}) const {
        return Words{"-i",       "udp://127.0.0.1:" + std::to_string(port_),
                     "-o",       out_,
                     "--no-map", "--queue",
                     "1000"} +
               more;
    }

    /** `period_us`: 1327 is the sensor's. */
    void send(const std::vector<Bytes>& packets, int period_us = 133) const {
        for (const Bytes& packet : packets) {
            sensor_.send(packet, port_);
            std::this_thread::sleep_for(std::chrono::microseconds(period_us));
        }
    }

    /** Sends packets to a run of its own that ends when none has come for some time. */
    test::CommandResult drive(const std::vector<Bytes>& packets, const Words& more = {},
                              int period_us = 133) const {
        test::RunningTool run("delio-slam", words(Words{"--idle", "3"} + more));
        EXPECT_TRUE(test::waitForListener(port_));
        send(packets, period_us);
        return run.wait();
    }

    /** The recording gives the same files. */
    void expectSameAgain(std::size_t fewest, const Words& more = {}) const {
        const fs::path again = folder_ / "again";
        const auto run = test::runTool(
            "delio-slam",
            Words{"-i", out_ / "packets.pcap", "-o", again, "--no-map", "--force"} + more);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        for (const char* const name : {"trajectory_kitti.txt", "trajectory_odometry_kitti.txt",
                                       "trajectory_tum.txt", "posegraph.g2o", "config.ini"})
            EXPECT_EQ(readText(again / name), readText(out_ / name)) << name;
        EXPECT_GE(rows("trajectory_kitti.txt"), fewest);
        expectNothingPartial();
    }

    bool warns(const std::string& part) const {
        return readText(out_ / "summary.yaml").find(part) != std::string::npos;
    }

    std::size_t live(const std::string& name) const {
        return summary()["live"][name].as<std::size_t>();
    }

    const std::uint16_t port_ = test::freePort();
    const test::UdpEnd sensor_;
};

TEST_F(Live, GivesTheResultsOfItsRecording) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    for (const int period_us : {1327, 133}) {
        const auto run = drive(vlp16(), {"--force"}, period_us);
        ASSERT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.err.find("reading Velodyne VLP-16, "), std::string::npos) << run.err;
        EXPECT_NE(run.out.find("latency "), std::string::npos) << run.out;
        EXPECT_TRUE(summary()["complete"].as<bool>());
        EXPECT_EQ(live("scans_dropped"), 0U);
        EXPECT_LE(live("packets") + live("packets_lost"), 1000U);
        expectSameAgain(5);
    }
}

TEST_F(Live, PrintsPosesAsTheyCome) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const auto tum = drive(vlp16(), {"--poses", "tum"});
    ASSERT_EQ(tum.exitCode, 0) << tum.err;
    // The ninth scan, as the first turn is not whole, corrects earlier ones: their lines are out.
    const auto printed = test::linesOf(tum.out),
               written = test::linesOf(readText(out_ / "trajectory_tum.txt"));
    ASSERT_EQ(printed.size(), written.size());
    for (std::size_t i = 8; i < printed.size(); ++i) EXPECT_EQ(printed[i], written[i]);
    EXPECT_NE(tum.err.find("peak memory"), std::string::npos) << tum.err;
    const test::UdpEnd listener;
    const auto json = drive(vlp16(), {"--force", "--poses", "json", "--publish",
                                      "udp://127.0.0.1:" + std::to_string(listener.port())});
    ASSERT_EQ(json.exitCode, 0) << json.err;
    const auto lines = test::linesOf(json.out);
    EXPECT_EQ(lines.size(), rows("trajectory_kitti.txt"));
    for (const auto& line : lines) {
        const auto pose = mrpt::containers::yaml::FromText(line);
        EXPECT_EQ(pose["frame"].as<std::string>(), "start");
        EXPECT_EQ(pose["position_m"].asSequence().size(), 3U);
        EXPECT_EQ(pose["quaternion_xyzw"].asSequence().size(), 4U);
        EXPECT_GE(pose["latency_ms"].as<double>(), 0);
        EXPECT_EQ(listener.receive(), line + "\n");
    }
}

TEST_F(Live, LossDuplicatesAndReorderingChangeNothingButTheScans) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    auto packets = vlp16();
    std::mt19937 random(3);
    std::vector<Bytes> sent;
    for (std::size_t i = 0; i < packets.size(); ++i) {
        const auto drawn = random() % 100;
        if (drawn < 2) continue;
        if (drawn < 4 && i + 1 < packets.size()) std::swap(packets[i], packets[i + 1]);
        sent.push_back(packets[i]);
        if (drawn > 97) sent.push_back(packets[i]);
    }
    const auto run = drive(sent);
    ASSERT_EQ(run.exitCode, 0) << run.err;
    expectSameAgain(5);
}

TEST_F(Live, HostilePacketsAndAnotherSensorAreCounted) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const test::UdpEnd other("127.0.0.2");
    std::mt19937 random(5);
    const auto noise = [&](std::size_t bytes) {
        Bytes packet(bytes);
        for (auto& byte : packet) byte = static_cast<std::uint8_t>(random());
        return packet;
    };
    test::RunningTool run("delio-slam", words({"--idle", "3"}));
    ASSERT_TRUE(test::waitForListener(port_));
    const auto packets = vlp16();
    for (std::size_t i = 0; i < packets.size(); ++i) {
        send({packets[i]});
        if (i < 20 || i % 50 > 0) continue;
        other.send(packets[i - 1], port_);
        Bytes wrong = packets[i];
        wrong[1205] = 0x99;  // a model that there is not
        Bytes cut(packets[i].begin(), packets[i].begin() + 600);
        Bytes helios = noise(1248), hesai = noise(1080);
        const Bytes mark{0x55, 0xAA, 0x05, 0x5A};
        std::copy(mark.begin(), mark.end(), helios.begin());
        hesai[0] = 0xEE;
        hesai[1] = 0xFF;
        send({wrong, cut, {}, noise(1), noise(60000), helios, hesai, noise(6464)});
    }
    const auto ended = run.wait();
    ASSERT_EQ(ended.exitCode, 0) << ended.err;
    EXPECT_TRUE(warns("not understood were ignored")) << ended.err;
    EXPECT_TRUE(warns("of no supported LiDAR were ignored")) << ended.err;
    const std::string name = "velodyne:" + std::to_string(port_) + "@127.0.0.2";
    EXPECT_TRUE(warns("packets of " + name + " were ignored: ")) << ended.err;
    EXPECT_TRUE(warns("scans of the sensor '" + name + "' are ignored")) << ended.err;
    expectSameAgain(5);
}

TEST_F(Live, ASensorThatRestarts) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    auto packets = vlp16();
    const auto clockOf = [](const Bytes& packet) {
        std::uint32_t us = 0;
        std::memcpy(&us, packet.data() + 1200, 4);
        return us;
    };
    const std::size_t half = packets.size() / 2;
    const std::uint32_t then_us = clockOf(packets[half]);
    for (std::size_t i = half; i < packets.size(); ++i)
        test::putAt(packets[i], 1200, clockOf(packets[i]) - then_us);
    const auto run = drive(packets, {}, 1327);
    ASSERT_EQ(run.exitCode, 0) << run.err;
    expectSameAgain(5);
}

TEST_F(Live, ASignalEndsTheDriveAndAllIsWritten) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    for (const int signal : {SIGTERM, SIGINT}) {
        test::RunningTool run("delio-slam", words({"--force", "--verbose"}));
        ASSERT_TRUE(test::waitForListener(port_));
        // The sensor never stops. A start of a few scans alone would be weakly observed.
        const auto packets = vlp16();
        for (std::size_t i = 0; run.err().find("scan 6: ") == std::string::npos; ++i) {
            ASSERT_FALSE(run.hasEnded()) << run.err();
            send({packets[i % packets.size()]}, 1000);
        }
        run.send(signal);
        const auto ended = run.wait();
        EXPECT_EQ(ended.exitCode, 0) << ended.err;
        EXPECT_TRUE(summary()["complete"].as<bool>());
        expectSameAgain(7);
    }
}

TEST_F(Live, ASignalBeforeTheFirstPacketLeavesNothing) {
    test::RunningTool run("delio-slam", words());
    ASSERT_TRUE(test::waitForListener(port_));
    run.send(SIGTERM);
    EXPECT_EQ(run.wait().exitCode, 130);
    EXPECT_FALSE(fs::exists(out_));
}

/** Where nobody reads the poses, the odometry waits and the queue runs over. */
TEST_F(Live, DropsWholeScansWhereItCannotKeepUp) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = open(pipe.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 4096> bytes{};
    while (write(reader, bytes.data(), bytes.size()) > 0) continue;
    while (write(reader, bytes.data(), 1) > 0) continue;
    const Words tool =
        Words{"-c", "exec \"$0\" \"$@\" >'" + pipe.string() + "'", test::toolPath("delio-slam")} +
        words({"--idle", "3", "--poses", "tum", "--queue", "1"});
    test::RunningTool run("bash", tool);
    ASSERT_TRUE(test::waitForListener(port_));
    send(vlp16());
    while (run.err().find("some are dropped") == std::string::npos) {
        ASSERT_FALSE(run.hasEnded()) << run.err();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    while (!run.hasEnded())
        if (read(reader, bytes.data(), bytes.size()) <= 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    close(reader);
    const auto ended = run.wait();  // with 0, or 1 where too few scans are left to be relied on
    EXPECT_TRUE(summary()["complete"].as<bool>()) << ended.err;
    EXPECT_GE(live("scans_dropped"), 1U);
    EXPECT_TRUE(warns("scans were dropped")) << ended.err;
    const std::size_t processed = rows("trajectory_kitti.txt");
    const auto again = test::runTool(
        "delio-slam", {"-i", out_ / "packets.pcap", "-o", folder_ / "again", "--no-map"});
    EXPECT_EQ(again.exitCode, 0) << again.err;
    const auto all = test::linesOf(readText(folder_ / "again/trajectory_kitti.txt")).size();
    EXPECT_EQ(processed + live("scans_dropped"), all);
}

TEST_F(Live, AFullDiskEndsTheRecordingOnly) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const auto run = drive(vlp16(), {"--record", "/dev/full"});
    EXPECT_EQ(run.exitCode, 0) << run.err;
    const std::string warning = "packets are not recorded to '/dev/full'";
    const auto at = run.err.find(warning);
    ASSERT_NE(at, std::string::npos) << run.err;
    EXPECT_EQ(run.err.find(warning, at + 1), std::string::npos) << run.err;
    EXPECT_GE(rows("trajectory_kitti.txt"), 5U);
    EXPECT_FALSE(fs::exists(out_ / "packets.pcap"));
}

TEST_F(Live, ARecordingReplacesNoOtherFile) {
    const fs::path kept = folder_ / "kept.pcap";
    test::writeText(kept, "precious");
    expectRefused(test::runTool("delio-slam", words({"--record", kept})), 1,
                  {"kept.pcap", "--force"});
    EXPECT_EQ(readText(kept), "precious");
}

TEST_F(Live, APortInUse) {
    const test::UdpEnd taken;
    const std::string port = std::to_string(taken.port());
    expectRefused(test::runTool("delio-slam", {"-i", "udp://127.0.0.1:" + port, "-o", out_}), 1,
                  {"cannot listen to port " + port});
}

TEST_F(Live, OptionsThatNeedALiveSensor) {
    writeDrive();
    for (const Words& option :
         {Words{"--record", "a.pcap"}, {"--no-record"}, {"--idle", "1"}, {"--queue", "2"}})
        expectRefused(slam(option), 2, {option.front(), "udp://"});
    expectRefused(test::runTool("delio-slam", words({"--idle", "-1"})), 2, {"--idle"});
    expectRefused(test::runTool("delio-slam", words({"--queue", "0"})), 2, {"--queue"});
    expectRefused(test::runTool("delio-slam", {"-i", rawlog_, "-i", "udp://:2368", "-o", out_}), 2,
                  {"only input"});
    for (const char* target : {"127.0.0.1:9", "udp://127.0.0.1:99999", "udp://127.0.0.1:0"})
        expectRefused(test::runTool("delio-slam", words({"--publish", target})), 1,
                      {"udp://HOST:PORT"});
    expectRefused(test::runTool("delio-slam", {"-i", "udp://localhost", "-o", out_}), 1,
                  {"udp://localhost", "PORT"});
}

TEST_F(Live, PosesOfARecording) {
    writeDrive();
    const auto run = slam({"--poses", "tum"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(run.out, readText(out_ / "trajectory_tum.txt"));
    const auto full =
        test::runTool("sh", {"-c", "exec \"$0\" \"$@\" > /dev/full", test::toolPath("delio-slam"),
                             "-i", rawlog_, "-o", out_, "--force", "--no-map", "--poses", "tum"});
    EXPECT_EQ(full.exitCode, 0) << full.err;
    EXPECT_NE(full.err.find("cannot write the poses to stdout: No space"), std::string::npos)
        << full.err;
}
}  // namespace
