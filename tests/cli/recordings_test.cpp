// The tools on what others record: bags, pcaps and folders, beside the same scans in a rawlog.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>

#include "bag_writers.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio_slam_fixture.h"
#include "pcap_writer.h"

namespace {
using namespace delio;
using test::expectFailure;
using test::readText;
using test::runTool;
using test::Words;
using test::operator+;
namespace fs = std::filesystem;
using Kind = test::WireWriter::Kind;

/** Blocks of pcapng instead of the records of pcap. */
void writePcapNg(const fs::path& file, const test::PcapWriter& packets) {
    test::Bytes all;
    const auto block = [&](std::uint32_t type, test::Bytes body) {
        body.resize((body.size() + 3) / 4 * 4);
        test::Bytes bytes(8);
        test::putAt(bytes, 0, type);
        const auto length = static_cast<std::uint32_t>(body.size() + 12);
        test::putAt(bytes, 4, length);
        bytes.insert(bytes.end(), body.begin(), body.end());
        bytes.resize(bytes.size() + 4);
        test::putAt(bytes, bytes.size() - 4, length);
        all.insert(all.end(), bytes.begin(), bytes.end());
    };
    test::Bytes section(16, 0xFF);
    test::putAt(section, 0, std::uint32_t{0x1A2B3C4D});
    test::putAt(section, 4, std::uint32_t{1});
    block(0x0A0D0D0A, section);
    test::Bytes interface(8);
    test::putAt(interface, 0, packets.linkType);
    block(1, interface);
    for (std::size_t at = 0; at < packets.records.size();) {
        std::uint32_t head[4];
        std::memcpy(head, packets.records.data() + at, sizeof(head));
        const std::uint64_t us = 1000000ULL * head[0] + head[1];
        test::Bytes body(20);
        test::putAt(body, 4, static_cast<std::uint32_t>(us >> 32U));
        test::putAt(body, 8, static_cast<std::uint32_t>(us));
        test::putAt(body, 12, head[2]);
        test::putAt(body, 16, head[3]);
        const auto* data = packets.records.data() + at + sizeof(head);
        body.insert(body.end(), data, data + head[2]);
        block(6, body);
        at += sizeof(head) + head[2];
    }
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(all.data()), static_cast<std::streamsize>(all.size()));
}

class Recordings : public test::DelioSlam {
 protected:
    /** The toy drive's scans as messages. */
    static test::BagContents contents(Kind kind) {
        test::BagContents contents;
        const bool ros1 = kind == Kind::kRos1;
        contents.topics = {{"/points", ros1 ? "sensor_msgs/PointCloud2"  //
                                            : "sensor_msgs/msg/PointCloud2"}};
        if (!ros1) contents.encoding = "cdr";
        double stamp_s = io::kDriveEpoch_s;
        for (const auto& scan : test::toyScans(kScans)) {
            test::CloudSpec spec;
            spec.stamp_s = stamp_s;
            spec.columns = static_cast<std::uint32_t>(scan.size() / 4);
            spec.xyzi = &scan;
            contents.messages.push_back({0, stamp_s, test::cloudMessage(spec, kind)});
            stamp_s += 0.1;
        }
        return contents;
    }

    std::vector<Eigen::Isometry3d> posesOf(const fs::path& folder) const {
        return io::readTrajectory((folder / "trajectory_kitti.txt").string()).poses;
    }

    void expectPosesOf(const fs::path& recording, const fs::path& reference,
                       const Words& more = {}) const {
        const auto run = slamOf(recording, Words{"--force"} + more);
        ASSERT_EQ(run.exitCode, 0) << recording << run.err;
        const auto poses = posesOf(out_), expected = posesOf(reference);
        ASSERT_EQ(poses.size(), expected.size()) << recording;
        for (std::size_t i = 0; i < poses.size(); ++i)
            EXPECT_TRUE(poses[i].isApprox(expected[i], 1e-5)) << recording << " " << i;
    }

    /** A VLP-16 that was driven: its packets as MRPT's sample has them. */
    static test::PcapWriter vlp16() {
        const std::string packets =
            readText((test::dataFolder() / "mrpt/vlp16_packets_1206.bin").string());
        test::PcapWriter pcap;
        for (std::size_t at = 0; at + 1206 <= packets.size(); at += 1206)
            pcap.add(test::Bytes(packets.begin() + static_cast<std::ptrdiff_t>(at),
                                 packets.begin() + static_cast<std::ptrdiff_t>(at + 1206)),
                     1.6e9 + 0.00133 * static_cast<double>(at) / 1206);
        return pcap;
    }
};

TEST_F(Recordings, BagsGiveTheTrajectoryOfTheRawlog) {
    const fs::path reference = folder_ / "reference";
    writeDrive();
    ASSERT_EQ(runTool("delio-slam", {"-i", rawlog_, "-o", reference, "--no-map"}).exitCode, 0);
    test::writeRos1Bag(folder_ / "d.bag", contents(Kind::kRos1), "lz4");
    test::writeRos1Bag(folder_ / "d.bag.active", contents(Kind::kRos1), "none",
                       test::Index::kNever);
    test::writeMcap(folder_ / "d.mcap", contents(Kind::kCdr), "zstd");
    test::writeDatabase(folder_ / "d.db3", contents(Kind::kCdr));
    for (const char* name : {"d.bag", "d.bag.active", "d.mcap", "d.db3"})
        expectPosesOf(folder_ / name, reference);
    expectFailure(slamOf(folder_ / "d.bag", {"--force", "--sensor-label", "/other"}), 1,
                  {"/other", "/points"});
}

TEST_F(Recordings, ABagThatIsCutOffIsUsedUpToTheCut) {
    test::writeRos1Bag(folder_ / "d.bag", contents(Kind::kRos1), "none", test::Index::kWritten, 1);
    const std::string bytes = readText(folder_ / "d.bag");
    test::writeText(folder_ / "cut.bag", bytes.substr(0, 3 * bytes.size() / 4));
    expectFailure(slamOf(folder_ / "cut.bag"), 1, {"cut.bag", "cut off"});
    expectPart(3);
}

TEST_F(Recordings, PcapsOfAVlp16) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const auto packets = vlp16();
    packets.write(folder_ / "v.pcap");
    writePcapNg(folder_ / "v.pcapng", packets);
    const fs::path reference = folder_ / "reference";
    const auto run = runTool("delio-slam", {"-i", folder_ / "v.pcap", "-o", reference, "--no-map"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("reading Velodyne VLP-16, "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("points with times, not de-skewed by the recorder (pcap)"),
              std::string::npos)
        << run.err;
    EXPECT_GE(posesOf(reference).size(), 10U);
    expectPosesOf(folder_ / "v.pcapng", reference);
    const auto made = folder_ / "made.rawlog";
    const auto written = runTool("scans2rawlog", {"-i", folder_ / "v.pcap", "-o", made});
    ASSERT_EQ(written.exitCode, 0) << written.err;
    expectPosesOf(made, reference);
    const auto piped =
        runTool("sh", {"-c", "cat '" + (folder_ / "v.pcap").string() + "' | " +
                                 test::toolPath("delio-slam") + " -i - --force --no-map -o '" +
                                 out_.string() + "'"});
    ASSERT_EQ(piped.exitCode, 0) << piped.err;
    EXPECT_EQ(readText(out_ / "trajectory_kitti.txt"),
              readText(reference / "trajectory_kitti.txt"));
}

TEST_F(Recordings, PcapsOfAnOuster) {
    DELIO_NEED_DATA("ouster/OS-1-128_v2.3.0_1024x10.json");
    const auto ouster = test::dataFolder() / "ouster";
    const fs::path pcap = ouster / "OS-1-128_v2.3.0_1024x10_lb_n3.pcap";
    const Words info = {"--sensor-info", ouster / "OS-1-128_v2.3.0_1024x10.json"};
    const auto made = folder_ / "made.rawlog";
    const auto written = runTool("scans2rawlog", Words{"-i", pcap, "-o", made} + info);
    ASSERT_EQ(written.exitCode, 0) << written.err;
    EXPECT_NE(written.err.find("wrote 3 scans"), std::string::npos) << written.err;
    io::RawlogReader reader(made);
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->rings.size(), scan->points->size());
    EXPECT_EQ(scan->times_s.size(), scan->points->size());
    const auto run = slamOf(pcap, info);
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(posesOf(out_).size(), 3U);
    EXPECT_EQ(slamOf(pcap, {"--force"}).exitCode, 0);  // the json is found by its name
    const auto alone = folder_ / "alone.pcap";
    fs::create_symlink(pcap, alone);
    expectFailure(slamOf(alone, {"--force"}), 1, {"--sensor-info"});
    expectFailure(
        slamOf(pcap, {"--force", "--sensor-info", ouster / "OS-0-32-U1_v2.2.0_1024x10.json"}), 1,
        {"122201000998", "992137000142"});
    expectFailure(slamOf(pcap, {"--force", "--sensor-info", folder_ / "none.json"}), 1,
                  {"none.json"});
}
/** Records of 28 bytes: x y z intensity, time, reflectivity, ambient light, range. */
TEST_F(Recordings, BinFilesOfAnotherLayout) {
    const fs::path kitti = folder_ / "kitti", pohang = folder_ / "pohang",
                   reference = folder_ / "reference";
    fs::create_directories(kitti);
    fs::create_directories(pohang);
    std::size_t number = 0;
    for (const auto& scan : test::toyScans(kScans)) {
        const std::string name = std::to_string(number++) + ".bin";
        const std::size_t count = scan.size() / 4;
        std::string plain, timed;
        for (std::size_t i = 0; i < count; ++i) {
            plain.append(reinterpret_cast<const char*>(&scan[4 * i]), 16);
            timed.append(reinterpret_cast<const char*>(&scan[4 * i]), 16);
            const std::uint32_t more[3]{static_cast<std::uint32_t>(100'000'000 * i / count), 0, 0};
            timed.append(reinterpret_cast<const char*>(more), sizeof(more));
        }
        test::writeText(kitti / name, plain);
        test::writeText(pohang / name, timed);
    }
    ASSERT_EQ(runTool("delio-slam", {"-i", kitti, "-o", reference, "--no-map"}).exitCode, 0);
    expectPosesOf(pohang, reference, {"--set", "scan.deskew=false"});
    const auto run = slamOf(pohang, {"--force", "--sensor-label", "pohang"});
    EXPECT_NE(run.err.find("folder of .bin files, layout pohang"), std::string::npos) << run.err;
    expectFailure(slamOf(pohang, {"--force", "--sensor-label", "velodyne"}), 1,
                  {"no layout 'velodyne'", "kitti", "boreas", "mulran"});
    expectFailure(slamOf(pohang, {"--force", "--sensor-label", "boreas"}), 1,
                  {"0.bin", "multiple of 24"});
}

TEST_F(Recordings, OsfOfAnOuster) {
    test::writeText(folder_ / "d.osf", "no OSF");
    expectFailure(slamOf(folder_ / "d.osf"), 1, {"d.osf", "is not an OSF file"});
    const char* const peers = std::getenv("DELIO_PEER_DATA");
    const fs::path sdk = fs::path(peers ? peers : "") / "ouster-sdk/tests";
    if (!fs::exists(sdk)) GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    const fs::path reference = folder_ / "reference";
    const auto pcap = runTool(
        "delio-slam", {"-i", sdk / "pcaps/OS-1-128_v2.3.0_1024x10_lb_n3.pcap", "--sensor-info",
                       sdk / "pcaps/OS-1-128_v2.3.0_1024x10.json", "-o", reference, "--no-map"});
    ASSERT_EQ(pcap.exitCode, 0) << pcap.err;
    const auto osf = slamOf(sdk / "osfs/OS-1-128_v2.3.0_1024x10_lb_n3.osf", {"--force"});
    ASSERT_EQ(osf.exitCode, 0) << osf.err;
    EXPECT_NE(osf.err.find("reading Ouster OS-1-128, "), std::string::npos) << osf.err;
    // The pcap has the sensor's IMU, too.
    const auto poses = posesOf(out_), expected = posesOf(reference);
    ASSERT_EQ(poses.size(), 3U);
    ASSERT_EQ(expected.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_LT((poses[i].translation() - expected[i].translation()).norm(), 0.01) << i;
    const auto damaged = slamOf(sdk / "osfs/bad_crc32.osf", {"--force"});
    expectFailure(damaged, 1, {"bad_crc32.osf", "wrong checksum"});
}
}  // namespace
