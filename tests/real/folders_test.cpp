// Real scans where they lie: the same as by way of kitti2rawlog.
#include <gtest/gtest.h>

#include "command.h"
#include "delio/recordings/rawlog_reader.h"
#include "recordings/sources.h"
#include "same_scans.h"
#include "test_data.h"

namespace {
using namespace delio;
using Words = std::vector<std::string>;

void expectTheSame(const std::string& folder, const Words& more, std::size_t scans) {
    const test::TemporaryFolder out;
    const std::string rawlog = out / "d.rawlog";
    Words words = {"-i", folder, "-o", rawlog};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = test::runTool("kitti2rawlog", words);
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto reader = io::openKittiFolder({folder, "", "", ""});
    io::RawlogReader converted(rawlog);
    EXPECT_EQ(test::expectSameScans(*reader, converted), scans);
    test::expectSameDrive(*reader, converted);
}

TEST(RealFolders, KittiInPlace) {
    DELIO_NEED_DATA("kitti/00_first16");
    const std::string folder = (test::dataFolder() / "kitti/00_first16").string();
    for (const Words& more : {Words(), Words{"--link"}, Words{"--embed"}})
        expectTheSame(folder, more, 16);
}

// The same files as clouds of any sensor.
TEST(RealFolders, KittisScansAsClouds) {
    DELIO_NEED_DATA("kitti/00_first16");
    const auto folder = test::dataFolder() / "kitti/00_first16";
    const auto kitti = io::openKittiFolder({folder.string(), "", "", ""});
    const auto clouds = io::openCloudFolder({(folder / "velodyne").string(), "", "", ""});
    EXPECT_EQ(test::expectSameScans(*clouds, *kitti), 16U);
}
}  // namespace
