#include <regex>

#include "bag_files.h"
#include "command.h"

/** Agreement with ROS's own tool, where it is installed (Debian: python3-rosbag). */
namespace delio::bag_test {
namespace {
bool haveRosbag() { return test::runTool("rosbag", {"info", "-h"}).exitCode == 0; }

/** What `rosbag info -y -k KEY` says. */
std::string infoOf(const std::filesystem::path& file, const std::string& key) {
    const auto result = test::runTool("rosbag", {"info", "-y", "-k", key, file.string()});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.out;
}

double numberOf(const std::filesystem::path& file, const std::string& key) {
    const std::string text = infoOf(file, key);
    return text.empty() ? -1 : std::stod(text);
}

struct Seen {
    std::size_t scans = 0;
    double first_s = 0, last_s = 0;
};

Seen seenIn(const std::filesystem::path& file) {
    const auto reader = io::openRos1Bag({file.string(), "", "", ""});
    Seen seen;
    while (const auto scan = reader->next()) {
        expectScan(*scan, seen.scans, 3000);
        if (seen.scans == 0) seen.first_s = scan->stamp_s;
        seen.last_s = scan->stamp_s;
        ++seen.scans;
    }
    EXPECT_EQ(reader->recording().scans, seen.scans);
    return seen;
}
}  // namespace

#define DELIO_NEED_ROSBAG() \
    if (!haveRosbag()) GTEST_SKIP() << "rosbag is not installed (python3-rosbag)"

TEST(BagRosbag, AgreesOnCountsAndTimes) {
    DELIO_NEED_ROSBAG();
    for (const char* compression : {"none", "bz2", "lz4"}) {
        SCOPED_TRACE(compression);
        const test::TemporaryFolder folder;
        const auto file = folder / "d.bag";
        writeRos1Bag(file, drive(5, Kind::kRos1, 3000), compression);
        const Seen seen = seenIn(file);
        // Messages are recorded 10 and 20 ms after their stamps.
        EXPECT_EQ(numberOf(file, "messages"), 2.0 * static_cast<double>(seen.scans));
        EXPECT_NEAR(numberOf(file, "start"), seen.first_s + 0.01, 1e-5);
        EXPECT_NEAR(numberOf(file, "end"), seen.last_s + 0.02, 1e-5);
        EXPECT_EQ(infoOf(file, "compression").substr(0, 3), std::string(compression).substr(0, 3));
        const std::string topics = infoOf(file, "topics");
        EXPECT_TRUE(std::regex_search(
            topics, std::regex("topic: /points\\s+type: sensor_msgs/PointCloud2\\s+messages: 5")))
            << topics;
    }
}

TEST(BagRosbag, ItsOwnCompressionIsRead) {
    DELIO_NEED_ROSBAG();
    for (const std::string compression : {"lz4", "bz2"}) {
        SCOPED_TRACE(compression);
        const test::TemporaryFolder folder;
        const auto file = folder / "d.bag";
        writeRos1Bag(file, drive(5, Kind::kRos1, 3000));
        const auto result =
            test::runTool("rosbag", {"compress", "--" + compression, "-q", file.string()});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        EXPECT_EQ(infoOf(file, "compression").substr(0, 3), compression);
        EXPECT_EQ(seenIn(file).scans, 5U);
    }
}

TEST(BagRosbag, CutBagHasWhatReindexFinds) {
    DELIO_NEED_ROSBAG();
    const test::TemporaryFolder folder;
    const auto file = folder / "d.bag";
    writeRos1Bag(file, drive(9, Kind::kRos1, 3000), "bz2", Index::kNever);
    // (Debian 12's reindex does nothing for lz4.)
    const std::string whole = test::readText(file);
    test::writeText(file, whole.substr(0, whole.size() * 2 / 3));
    const Outcome ours = readAll(io::openRos1Bag, {file.string(), "", "", ""});
    EXPECT_NE(ours.fault, "");
    const auto result = test::runTool("rosbag", {"reindex", "-q", file.string()});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(numberOf(file, "messages"), 2.0 * static_cast<double>(ours.scans));
    EXPECT_EQ(seenIn(file).scans, ours.scans);
}
}  // namespace delio::bag_test
