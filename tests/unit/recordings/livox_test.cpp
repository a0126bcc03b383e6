// Livox's CustomMsg.
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>

#include "bag_files.h"
#include "recordings/compensation.h"
#include "recordings/scan_maker.h"
#include "recordings/scan_parts.h"
#include "rosette.h"

namespace delio::bag_test {
namespace {
using test::RosetteDrive;

std::vector<Scan> scansOf(io::ScanReader& reader) {
    std::vector<Scan> scans;
    while (auto scan = reader.next()) scans.push_back(std::move(*scan));
    return scans;
}

RosetteDrive shortDrive(Kind kind, double message_s) {
    RosetteDrive drive;
    drive.kind = kind;
    drive.seconds = 0.6;
    drive.message_s = message_s;
    drive.pointsPerSecond = 6000;
    return drive;
}

/** Every point lies on its beam at its time. */
void expectOnBeams(const Scan& scan, const RosetteDrive& drive) {
    ASSERT_EQ(scan.times_s.size(), scan.points->size());
    EXPECT_TRUE(scan.rings.empty());
    const auto* cloud = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scan.points.get());
    ASSERT_TRUE(cloud);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
        float x = 0, y = 0, z = 0;
        cloud->getPoint(i, x, y, z);
        const double t = scan.stamp_s - drive.begin_s + static_cast<double>(scan.times_s[i]);
        const Eigen::Vector3d beam = test::rosetteBeam(t, static_cast<int>(i % 6));
        // 1 us is 0.04 deg of a prism's turn.
        ASSERT_GT(Eigen::Vector3d(x, y, z).normalized().dot(beam), std::cos(0.001)) << i;
        ASSERT_FLOAT_EQ(cloud->getPointIntensity(i), (50.0F + static_cast<float>(i % 6)) / 255);
    }
}

io::Message messageOf(const std::string& bytes, io::Encoding encoding = io::Encoding::kRos1,
                      double log_s = 0) {
    return {"/livox/lidar",
            "livox_ros_driver/CustomMsg",
            encoding,
            log_s,
            {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}};
}
}  // namespace

TEST(Livox, MessagesOfEveryContainer) {
    const test::TemporaryFolder folder;
    for (const Container& container : containers())
        for (const bool driver2 : {false, true}) {
            SCOPED_TRACE(container.name);
            RosetteDrive drive = shortDrive(container.kind, 0.1);
            drive.driver2 = driver2;
            const std::string file = folder / container.file;
            container.write(file, rosetteBag(drive));
            io::ScanSource source;
            source.path = file;
            const auto reader = container.open(source);
            const auto scans = scansOf(*reader);
            ASSERT_EQ(scans.size(), 6U);
            for (std::size_t i = 0; i < scans.size(); ++i) {
                EXPECT_EQ(scans[i].index, i);
                EXPECT_NEAR(scans[i].stamp_s, drive.begin_s + 0.1 * static_cast<double>(i), 1e-6);
                EXPECT_NEAR(mrpt::Clock::toDouble(scans[i].time), scans[i].stamp_s, 1e-6);
                EXPECT_EQ(scans[i].points->size(), 600U);
                expectOnBeams(scans[i], drive);
            }
            EXPECT_EQ(reader->recording().sensor, "Livox");
            EXPECT_EQ(reader->recording().motionCompensated, false);
            EXPECT_TRUE(reader->recording().findings.empty());
            std::filesystem::remove_all(file);
        }
}

TEST(Livox, ShortMessagesArePutTogether) {
    const test::TemporaryFolder folder;
    for (const double message_s : {0.01, 0.02, 0.05}) {
        const RosetteDrive drive = shortDrive(Kind::kCdr, message_s);
        writeMcap(folder / "d.mcap", rosetteBag(drive));
        const auto reader = io::openScans(folder / "d.mcap");
        const auto scans = scansOf(*reader);
        ASSERT_EQ(scans.size(), 6U) << message_s;
        for (std::size_t i = 0; i < scans.size(); ++i) {
            EXPECT_NEAR(scans[i].stamp_s, drive.begin_s + 0.1 * static_cast<double>(i), 1e-6);
            EXPECT_EQ(scans[i].points->size(), 600U);
            expectOnBeams(scans[i], drive);
        }
        EXPECT_EQ(io::describe(reader->recording()),
                  "Livox, 10 Hz, points with times, not de-skewed by the recorder (MCAP, topic "
                  "/livox/lidar)");
    }
}

TEST(Livox, LongMessagesStayAsTheyAre) {
    const test::TemporaryFolder folder;
    const RosetteDrive drive = shortDrive(Kind::kRos1, 0.2);
    writeRos1Bag(folder / "d.bag", rosetteBag(drive));
    const auto scans = scansOf(*io::openScans(folder / "d.bag"));
    ASSERT_EQ(scans.size(), 3U);
    for (const Scan& scan : scans) expectOnBeams(scan, drive);
}

TEST(Livox, TheSensorsClockTellsHowMessagesFollow) {
    const auto maker = io::makeLivoxMaker();
    RosetteDrive drive = shortDrive(Kind::kRos1, 0.02);
    for (int i = 0; i < 5; ++i) {
        RosetteDrive late = drive;  // a header that comes up to 8 ms late
        late.begin_s += 0.002 * i;
        maker->add(messageOf(livoxMessage(late, 0.02 * i, 0.02 * (i + 1))), 0);
    }
    maker->finish();
    const auto scan = maker->take();
    ASSERT_TRUE(scan);
    EXPECT_FALSE(maker->take());
    expectOnBeams(*scan, drive);
}

TEST(Livox, GapsAndClocksThatFallBeginAnotherScan) {
    const auto maker = io::makeLivoxMaker();
    const RosetteDrive drive = shortDrive(Kind::kRos1, 0.02);
    for (const double from_s : {0.0, 0.02, 0.2, 0.22, 0.1})
        maker->add(messageOf(livoxMessage(drive, from_s, from_s + 0.02)), 0);
    maker->finish();
    for (const double stamp_s : {0.0, 0.2, 0.1}) {
        const auto scan = maker->take();
        ASSERT_TRUE(scan);
        EXPECT_NEAR(scan->stamp_s - drive.begin_s, stamp_s, 1e-6);
        expectOnBeams(*scan, drive);
    }
    EXPECT_FALSE(maker->take());
}

TEST(Livox, HeaderWithoutStampHasTheTimeOfRecording) {
    const auto maker = io::makeLivoxMaker();
    RosetteDrive drive = shortDrive(Kind::kRos1, 0.1);
    drive.begin_s = 0;
    maker->add(messageOf(livoxMessage(drive, 0, 0.1), io::Encoding::kRos1, 1234.5), 0);
    maker->finish();
    EXPECT_EQ(maker->take().value().stamp_s, 1234.5);
}

TEST(Livox, AnotherLidarIsLeftOut) {
    const auto maker = io::makeLivoxMaker();
    const RosetteDrive drive = shortDrive(Kind::kRos1, 0.1);
    std::string other = livoxMessage(drive, 0.1, 0.2);
    // Behind seq, time, "livox_frame", timebase and point_num.
    other[4 + 8 + 4 + 11 + 8 + 4] = 2;
    maker->add(messageOf(livoxMessage(drive, 0, 0.1)), 0);
    maker->add(messageOf(other), 1);
    maker->finish();
    EXPECT_TRUE(maker->take());
    EXPECT_FALSE(maker->take());
    ASSERT_EQ(maker->findings().size(), 1U);
    EXPECT_EQ(maker->findings()[0],
              "messages of another lidar_id than 1: ignored: 1 scan (first: scan 1)");
}

TEST(Livox, MessagesThatAreCutOffAreRefused) {
    for (const Kind kind : {Kind::kRos1, Kind::kCdr}) {
        const auto encoding = kind == Kind::kRos1 ? io::Encoding::kRos1 : io::Encoding::kCdr;
        RosetteDrive drive = shortDrive(kind, 0.1);
        drive.pointsPerSecond = 60;
        const std::string whole = livoxMessage(drive, 0, 0.1);
        for (std::size_t size = 0; size < whole.size(); ++size) {
            const std::string part = whole.substr(0, size);
            EXPECT_THROW(io::makeLivoxMaker()->add(messageOf(part, encoding), 0), Error) << size;
        }
        io::makeLivoxMaker()->add(messageOf(whole, encoding), 0);
    }
}

TEST(Livox, ImpossibleTimesAreNone) {
    RosetteDrive drive = shortDrive(Kind::kRos1, 0.1);
    std::string message = livoxMessage(drive, 0, 0.1);
    const std::size_t first = message.size() - 600 * 19;
    for (std::size_t i = 0; i < 4; ++i) message[first + i] = '\xff';
    const auto maker = io::makeLivoxMaker();
    maker->add(messageOf(message), 3);
    maker->finish();
    const auto scan = maker->take();
    EXPECT_TRUE(std::isnan(scan.value().times_s[0]));
    EXPECT_FALSE(std::isnan(scan.value().times_s[1]));
    EXPECT_EQ(maker->findings().at(0),
              "points without a valid time: ignored: 1 point of 1 scan (first: scan 3)");
}
}  // namespace delio::bag_test
