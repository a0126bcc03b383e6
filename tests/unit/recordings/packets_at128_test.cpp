#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>

#include "at128_packets.h"
#include "delio/core/error.h"
#include "recordings/hesai_at128.h"
#include "recordings/sources.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
constexpr std::size_t kLasers = test::kAt128Rows;
constexpr double kBegin_s = 1700000000;

/** 0.1 s a field; the first 1200 azimuths are those of returns. */
std::vector<Scan> scansOf(io::PacketDecoder& decoder, int fields, std::uint8_t mode = 0x37) {
    std::vector<Scan> scans;
    for (int field = 0; field < fields; ++field)
        for (int shot = 0; shot < 1200; shot += mode == 0x37 ? 2 : 1) {
            const double time_s = kBegin_s + 0.1 * field + 41.666e-6 * shot;
            const Bytes packet = test::at128Packet(field % 3, shot, time_s, mode);
            decoder.add(packet.data(), packet.size(), time_s + 0.001);
            while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
        }
    decoder.finish();
    while (auto scan = decoder.take()) scans.push_back(std::move(*scan));
    return scans;
}

class PacketsAt128 : public testing::Test {
 protected:
    void SetUp() override { test::writeText(file_, test::at128File()); }
    std::unique_ptr<io::PacketDecoder> decoder() const { return io::hesaiDecoder(file_.string()); }
    std::string faultOf(const std::string& file) const {
        const Bytes packet = test::at128Packet(0, 0, kBegin_s);
        try {
            io::hesaiDecoder(file)->add(packet.data(), packet.size(), kBegin_s);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    test::TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_ / "at128.dat";
};

TEST_F(PacketsAt128, EachFieldIsAScan) {
    const auto ours = decoder();
    const auto scans = scansOf(*ours, 5);
    EXPECT_EQ(ours->sensor(), "Hesai AT128");
    ASSERT_EQ(scans.size(), 5U);
    for (std::size_t n = 0; n < scans.size(); ++n) {
        const Scan& scan = scans[n];
        ASSERT_EQ(scan.points->size(), 1200 * kLasers) << n;
        for (std::size_t i = 0; i < scan.points->size(); ++i) {
            const std::size_t laser = i % kLasers;
            const auto shot = static_cast<int>(i / kLasers);
            if (laser == 5) continue;
            float x = 0, y = 0, z = 0;
            scan.points->getPoint(i, x, y, z);
            const double range = 0.004 * test::at128Distance(laser, shot);
            const double across = (30 + 0.1 * shot + test::at128Across(laser)) * M_PI / 180,
                         up = test::at128Up(laser) * M_PI / 180;
            ASSERT_EQ(scan.rings[i], laser);
            ASSERT_NEAR(x, range * std::cos(up) * std::sin(across), 1e-4) << i;
            ASSERT_NEAR(y, range * std::cos(up) * std::cos(across), 1e-4) << i;
            ASSERT_NEAR(z, range * std::sin(up), 1e-4) << i;
        }
        EXPECT_NEAR(scan.stamp_s, kBegin_s + 0.1 * static_cast<double>(n), 2e-4);
        EXPECT_NEAR(scan.times_s[1199 * kLasers] - scan.times_s[0], 1199 * 41.666e-6, 1e-5);
        EXPECT_NEAR(scan.times_s[8] - scan.times_s[0], 12.424e-6, 1e-8);
    }
}

TEST_F(PacketsAt128, TwoReturns) {
    const auto ours = decoder();
    const auto scans = scansOf(*ours, 2, 0x39);
    ASSERT_EQ(scans.size(), 2U);
    EXPECT_EQ(scans[0].points->size(), 2 * 1200 * kLasers);
}

TEST_F(PacketsAt128, CorrectionsAreInterpolated) {
    const io::At128Angles angles(file_.string());
    std::size_t field = 9;
    EXPECT_NEAR(angles.withinField(170, field), 30, 1e-9);
    EXPECT_EQ(field, 1U);
    EXPECT_NEAR(angles.withinField(10, field), 110, 1e-9);
    EXPECT_EQ(field, 2U);
    const auto at = angles.direction(1, 170, 5), between = angles.direction(1, 170.5, 5),
               beside = angles.direction(1, 172, 5);
    EXPECT_NEAR(at.azimuth, 60 + test::at128Across(5) + 0.04, 1e-9);
    EXPECT_NEAR(at.elevation, test::at128Up(5) - 0.02, 1e-9);
    EXPECT_NEAR(between.azimuth, 61 + test::at128Across(5) + 0.03, 1e-9);
    EXPECT_NEAR(beside.azimuth, 64 + test::at128Across(5), 1e-9);
    EXPECT_NEAR(beside.elevation, test::at128Up(5), 1e-9);
}

TEST_F(PacketsAt128, FilesAreChecked) {
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos);
    };
    EXPECT_EQ(faultOf(file_.string()), "");
    has(faultOf(""), "--sensor-info FILE.dat");
    has(faultOf((folder_ / "none.dat").string()), "none.dat");
    const std::string good = test::at128File(), file = (folder_ / "b.dat").string();
    test::writeText(file, good.substr(0, 40000));
    has(faultOf(file), "it is cut off");
    test::writeText(file, "Channel,Elevation,Azimuth");
    has(faultOf(file), "it begins otherwise");
    auto other = good;
    other[3] = 3;
    test::writeText(file, other);
    has(faultOf(file), "version 1.3, not 1.5");
    other = good;
    other[5] = 0;
    test::writeText(file, other);
    has(faultOf(file), "its counts are wrong");
}

TEST_F(PacketsAt128, OfAPcap) {
    test::PcapWriter writer;
    for (int field = 0; field < 3; ++field)
        for (int shot = 0; shot < 1200; shot += 2) {
            const double time_s = kBegin_s + 0.1 * field + 41.666e-6 * shot;
            writer.add(test::at128Packet(field, shot, time_s), time_s);
        }
    writer.write((folder_ / "d.pcap").string());
    const auto reader = io::openScans({(folder_ / "d.pcap").string(), "", "", file_.string()});
    EXPECT_EQ(io::describe(reader->recording()),
              "Hesai AT128, 10 Hz, points with times, not de-skewed by the recorder (pcap)");
    std::size_t scans = 0;
    while (reader->next()) ++scans;
    EXPECT_EQ(scans, 3U);
}
}  // namespace
