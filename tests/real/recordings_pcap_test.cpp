// Pcaps of Velodyne and Ouster sensors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "delio/core/error.h"
#include "delio/recordings/scan_reader.h"
#include "pcap_writer.h"
#include "recordings/ouster.h"
#include "recordings/sources.h"
#include "recordings/udp_stream.h"
#include "test_data.h"

namespace {
using namespace delio;

struct Known {
    std::string file, json, sensor;
    std::vector<std::size_t> points;  //!< a scan
    double period_s;
};

void check(const std::string& path, const Known& known) {
    io::ScanSource source;
    source.path = path;
    if (!known.json.empty()) source.sensorFile = (test::dataFolder() / known.json).string();
    const auto reader = io::openPcap(source);
    EXPECT_EQ(reader->recording().sensor, known.sensor);
    EXPECT_FALSE(reader->meta()->motionCompensated);
    std::vector<std::size_t> points;
    std::vector<double> stamps_s;
    while (const auto scan = reader->next()) {
        points.push_back(scan->points->size());
        stamps_s.push_back(scan->stamp_s);
        ASSERT_EQ(scan->times_s.size(), scan->points->size());
        EXPECT_EQ(scan->times_s.front(), 0);
        EXPECT_TRUE(std::is_sorted(scan->times_s.begin(), scan->times_s.end()) ||
                    known.sensor == "Velodyne HDL-32E");
        EXPECT_LT(scan->times_s.back(), 1.01 * known.period_s);
        for (std::size_t i = 0; i < scan->points->size(); i += 7) {
            float x = 0, y = 0, z = 0;
            scan->points->getPoint(i, x, y, z);
            ASSERT_GT(std::hypot(x, y, z), 0.4);
            ASSERT_LT(std::hypot(x, y, z), 300);
        }
    }
    EXPECT_EQ(points, known.points) << path;
    EXPECT_TRUE(reader->recording().findings.empty()) << reader->recording().findings[0];
    for (std::size_t i = 2; i < stamps_s.size(); ++i)
        EXPECT_NEAR(stamps_s[i] - stamps_s[i - 1], known.period_s, 0.01 * known.period_s);
    EXPECT_NEAR(reader->fraction().value_or(0), 1, 1e-9);
}

TEST(RecordingsPcap, Velodyne) {
    DELIO_NEED_DATA("mrpt/vlp16_packets_1206.bin");
    const Known hdl32{
        "mrpt/sample_velodyne_hdl32.pcap", "", "Velodyne HDL-32E", {53405, 53475}, 0.1106};
    const Known vlp16{"mrpt/sample_velodyne_vlp16_gps.pcap",
                      "",
                      "Velodyne VLP-16",
                      {14522, 18561, 18554, 18482},
                      0.1};
    for (const Known& known : {hdl32, vlp16})
        check((test::dataFolder() / known.file).string(), known);

    std::ifstream in(test::dataFolder() / "mrpt/vlp16_packets_1206.bin", std::ios::binary);
    test::PcapWriter writer;
    test::Bytes packet(1206);
    for (int i = 0; in.read(reinterpret_cast<char*>(packet.data()), 1206); ++i)
        writer.add(packet, 1600000000 + 0.001327 * i);
    const test::TemporaryFolder folder;
    writer.write((folder / "packets.pcap").string());
    const Known packets{"",
                        "",
                        "Velodyne VLP-16",
                        {10108, 15364, 15325, 15248, 15244, 15310, 15293, 15265, 15282, 15274,
                         15326, 15306, 15296, 9393},
                        0.1};
    check((folder / "packets.pcap").string(), packets);
}

TEST(RecordingsPcap, Ouster) {
    DELIO_NEED_DATA("ouster");
    const std::vector<Known> all{
        {"ouster/OS-0-32-U1_v2.2.0_1024x10.pcap", "", "Ouster OS-0-32-U1", {21631}, 0.1},
        {"ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap",
         "",
         "Ouster OS-1-128",
         {107647, 107357, 107532},
         0.1},
        {"ouster/OS-1-64_1024x10_fw20.pcap", "", "Ouster", {16749}, 0.1}};
    for (const Known& known : all) check((test::dataFolder() / known.file).string(), known);
}

/** Both sensors hardly move. */
TEST(RecordingsPcap, ImuOfAnOuster) {
    DELIO_NEED_DATA("ouster");
    for (const char* const name :
         {"OS-0-32-U1_v2.2.0_1024x10.pcap", "OS-1-128_v2.3.0_1024x10_lb_n3.pcap"}) {
        const auto reader = io::openScans({(test::dataFolder() / "ouster" / name).string()});
        std::vector<ImuSample> samples;
        std::vector<double> stamps_s;
        while (const auto scan = reader->next()) {
            stamps_s.push_back(scan->stamp_s);
            for (const auto& sample : reader->takeImu()) samples.push_back(sample);
        }
        ASSERT_GE(samples.size(), 9 * stamps_s.size()) << name;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            EXPECT_NEAR(samples[i].acceleration_mps2.norm(), 9.81, 1.5) << name;
            EXPECT_LT(samples[i].rate_radps.norm(), 0.2) << name;
            const double before_s = i > 0 ? samples[i - 1].stamp_s : samples[i].stamp_s - 0.01;
            EXPECT_NEAR(samples[i].stamp_s - before_s, 0.01, 0.002);
            EXPECT_GT(samples[i].stamp_s, stamps_s.front() - 0.05) << name;
            EXPECT_LT(samples[i].stamp_s, stamps_s.back() + 0.15) << name;
        }
        EXPECT_EQ(reader->recording().imu, "at port 7503");
    }
}

TEST(RecordingsPcap, AnotherOustersDescriptionIsRefused) {
    DELIO_NEED_DATA("ouster");
    io::ScanSource source;  // packets of both have 8448 bytes
    source.path = (test::dataFolder() / "ouster/OS-0-32-U1_v2.2.0_1024x10.pcap").string();
    source.sensorFile = (test::dataFolder() / "ouster/OS-1-128_v2.3.0_1024x10.json").string();
    try {
        io::openPcap(source);
        FAIL() << "accepted";
    } catch (const Error& e) {
        for (const char* const serial : {"992137000142", "122201000998"})
            EXPECT_NE(std::string(e.what()).find(serial), std::string::npos) << e.what();
    }
}

/** MD5 sum of the ranges of the recording's first turn, row by row. */
std::string sumOfRanges(const std::string& stem) {
    const auto info = io::readOusterInfo(test::readText(stem + ".json"), stem + ".json");
    io::OusterFrame frame(info);
    io::UdpStream stream(stem + ".pcap");
    while (const auto datagram = stream.next()) {
        if (datagram->bytes != info.packetBytes()) continue;
        const io::OusterPacket packet(info, datagram->payload);
        if (frame.count == 0) frame.number = packet.frameOf(0);
        for (std::size_t column = 0; column < info.columnsPerPacket; ++column)
            if (packet.valid(column) && packet.frameOf(column) == frame.number)
                packet.copyTo(frame, column);
    }
    EXPECT_EQ(frame.count, 1024U);
    const test::TemporaryFolder folder;
    std::ofstream out(folder / "ranges", std::ios::binary);
    for (std::size_t row = 0; row < info.rows; ++row)
        for (std::size_t column = 0; column < info.columns; ++column)
            out.write(reinterpret_cast<const char*>(&frame.ranges_mm[column * info.rows + row]), 4);
    out.close();
    const std::string command =
        "md5sum " + (folder / "ranges").string() + " > " + (folder / "sum").string();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return test::readText(folder / "sum").substr(0, 32);
}

/** Ouster's digests of its recordings have MD5 sums of the fields. */
void expectSumOfDigest(const std::string& stem) {
    const std::string sum = sumOfRanges(stem);
    EXPECT_NE(test::readText(stem + "_digest.json").find("\"RANGE\": \"" + sum + "\""),
              std::string::npos)
        << stem << " " << sum;
}

TEST(RecordingsPcap, RangesAreThoseOfOustersDigest) {
    DELIO_NEED_DATA("ouster");
    expectSumOfDigest((test::dataFolder() / "ouster/OS-0-32-U1_v2.2.0_1024x10").string());
}

/** The recordings of Ouster's SDK (tests/pcaps), of which DELIO_PEER_DATA has a checkout. */
std::string ousterSdk(const std::string& name) {
    const char* const folder = std::getenv("DELIO_PEER_DATA");
    return std::string(folder ? folder : "") + "/ouster-sdk/tests/" + name;
}

TEST(Peers, RangesAreThoseOfOustersDigests) {
    if (!std::filesystem::exists(ousterSdk("pcaps")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    for (const char* const name :
         {"OS-0-128-U1_v2.3.0_1024x10", "OS-0-32-U1_v2.2.0_1024x10", "OS-1-32-G_v2.1.1_1024x10",
          "OS-2-128-U1_v2.3.0_1024x10", "OS-2-32-U0_v2.0.0_1024x10"})
        expectSumOfDigest(ousterSdk(std::string("pcaps/") + name));
}

/** Numbers that Ouster's SDK expects of this recording of a few packets (fusa_profile_test). */
TEST(Peers, FunctionalSafetyAsOustersSdkReadsIt) {
    if (!std::filesystem::exists(ousterSdk("pcaps")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    const std::string stem = ousterSdk("pcaps/OS-1-128_767798045_1024x10_20230712_120049");
    const auto info = io::readOusterInfo(test::readText(stem + ".json"), stem + ".json");
    io::UdpStream stream(stem + ".pcap");
    const auto datagram = stream.next();
    ASSERT_TRUE(datagram);
    ASSERT_EQ(datagram->bytes, 16640U);
    ASSERT_EQ(info.packetBytes(), 16640U);
    const io::OusterPacket packet(info, datagram->payload);
    EXPECT_EQ(packet.frameOf(0), 229);
    EXPECT_EQ(packet.ids().serial, info.ids.serial);
    EXPECT_EQ(packet.ids().initialization, info.ids.initialization);
    EXPECT_EQ(packet.time_ns(0), 647839983424U);
    EXPECT_EQ(packet.time_ns(15), 647841450008U);
    io::OusterFrame frame(info);
    for (std::size_t column = 0; column < 16; ++column) {
        EXPECT_EQ(packet.place(column), column);
        ASSERT_TRUE(packet.valid(column));
        packet.copyTo(frame, column);
    }
    const std::size_t column4 = 4 * info.rows;
    const std::vector<std::uint32_t> ranges_mm(
        frame.ranges_mm.begin() + static_cast<std::ptrdiff_t>(column4),
        frame.ranges_mm.begin() + static_cast<std::ptrdiff_t>(column4) + 8);
    EXPECT_EQ(ranges_mm, (std::vector<std::uint32_t>{0, 2328, 2328, 2320, 3096, 2312, 2304, 2280}));
    const std::vector<int> reflectivities{3, 26, 31, 32, 13, 38, 44, 45};
    for (std::size_t row = 0; row < 8; ++row)
        EXPECT_EQ(frame.reflectivities[column4 + row], reflectivities[row]) << row;
}

/** How many are read; each other one has to be refused in one line. */
std::size_t readOrRefused(const std::string& folder, const std::string& extension) {
    std::size_t read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(ousterSdk(folder))) {
        if (entry.path().extension() != extension) continue;
        std::size_t points = 0;
        std::string fault;
        try {
            const auto reader = io::openScans(entry.path().string());
            while (const auto scan = reader->next()) points += scan->points->size();
        } catch (const Error& e) {
            fault = e.what();
            EXPECT_EQ(fault.find('\n'), std::string::npos);
            EXPECT_NE(fault.find(entry.path().filename().string()), std::string::npos) << fault;
        }
        std::cout << entry.path().filename().string() << ": " << points << " points " << fault
                  << "\n";
        if (points > 0) ++read;
    }
    return read;
}

TEST(Peers, EveryPcapOfOustersSdk) {
    if (!std::filesystem::exists(ousterSdk("pcaps")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    EXPECT_GE(readOrRefused("pcaps", ".pcap"), 8U);
}

/** The first recording is there in both formats. */
TEST(Peers, OsfAndPcapOfOustersSdkAgree) {
    if (!std::filesystem::exists(ousterSdk("osfs")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    const auto osf = io::openScans(ousterSdk("osfs/OS-1-128_v2.3.0_1024x10_lb_n3.osf"));
    const auto pcap = io::openScans({ousterSdk("pcaps/OS-1-128_v2.3.0_1024x10_lb_n3.pcap"), "", "",
                                     ousterSdk("pcaps/OS-1-128_v2.3.0_1024x10.json")});
    EXPECT_EQ(osf->recording().sensor, pcap->recording().sensor);
    std::size_t scans = 0;
    double apart_s = 0;  // the recorder of the OSF wrote times of the sensor's clock
    while (const auto one = pcap->next()) {
        const auto other = osf->next();
        ASSERT_TRUE(other);
        if (scans++ == 0) apart_s = one->stamp_s - other->stamp_s;
        EXPECT_EQ(one->points->getPointsBufferRef_x(), other->points->getPointsBufferRef_x());
        EXPECT_EQ(one->points->getPointsBufferRef_y(), other->points->getPointsBufferRef_y());
        EXPECT_EQ(one->points->getPointsBufferRef_z(), other->points->getPointsBufferRef_z());
        EXPECT_EQ(one->rings, other->rings);
        EXPECT_EQ(one->times_s, other->times_s);
        EXPECT_NEAR(one->stamp_s - other->stamp_s, apart_s, 1e-6);
    }
    EXPECT_EQ(scans, 3U);
    EXPECT_FALSE(osf->next());
}

Eigen::Vector3d meanOf(const std::vector<Eigen::Vector3d>& vectors) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& vector : vectors) sum += vector;
    return sum / static_cast<double>(vectors.size());
}

TEST(Peers, ImuInAnOsfOfOustersSdk) {
    if (!std::filesystem::exists(ousterSdk("osfs")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    const auto reader = io::openScans(ousterSdk("osfs/pose_delta_1_128.osf"));
    const auto scan = reader->next();
    ASSERT_TRUE(scan);
    std::vector<Eigen::Vector3d> accelerations, rates;
    double before_s = scan->stamp_s;
    for (const auto& sample : reader->takeImu()) {
        accelerations.push_back(sample.acceleration_mps2);
        rates.push_back(sample.rate_radps);
        EXPECT_NEAR(sample.stamp_s - before_s, 0.1 / 64, 1e-4);
        before_s = sample.stamp_s;
    }
    EXPECT_EQ(rates.size(), 64U);
    EXPECT_NEAR(meanOf(accelerations).norm(), 9.8, 0.5);
    EXPECT_LT(meanOf(rates).norm(), 0.1);
}

TEST(Peers, ImuPacketsOfOustersSdk) {
    if (!std::filesystem::exists(ousterSdk("pcaps")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    std::ifstream json(ousterSdk("pcaps/imu_zm_no_lidar_0.json"));
    const auto info = io::readOusterInfo({std::istreambuf_iterator<char>(json), {}}, "json");
    io::UdpStream packets(ousterSdk("pcaps/imu_zm_no_lidar.pcap"));
    std::vector<io::OusterImu> samples;
    std::size_t taken = 0;
    while (const auto packet = packets.next())
        taken += io::addOusterImu(info, packet->payload, packet->bytes, samples);
    EXPECT_EQ(taken, 8U);
    std::vector<Eigen::Vector3d> accelerations, rates;
    for (const auto& sample : samples) {
        accelerations.push_back(sample.acceleration);
        rates.push_back(sample.rate);
    }
    EXPECT_EQ(rates.size(), 64U);
    EXPECT_NEAR(meanOf(accelerations).norm(), 9.8, 0.5);
    EXPECT_LT(meanOf(rates).norm(), 0.1);
}

TEST(Peers, EveryOsfOfOustersSdk) {
    if (!std::filesystem::exists(ousterSdk("osfs")))
        GTEST_SKIP() << "DELIO_PEER_DATA has no ouster-sdk";
    EXPECT_GE(readOrRefused("osfs", ".osf"), 8U);
}
}  // namespace
