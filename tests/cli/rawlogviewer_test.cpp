// RawLogViewer opens the rawlogs that our tools write, without a dialog; under Xvfb.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "command.h"
#include "test_data.h"
#include "virtual_display.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

/** A KITTI sequence of small scans, enough of them for the viewer to look at its progress. */
fs::path smallSequence(const test::TemporaryFolder& folder) {
    const fs::path sequence = folder / "sequence";
    fs::create_directories(sequence / "velodyne");
    std::ofstream times(sequence / "times.txt");
    for (int scan = 0; scan < 60; ++scan) {
        std::vector<float> xyzi;
        for (int i = 0; i < 400; ++i) {
            const auto x = static_cast<float>(i % 20), y = static_cast<float>(i / 20);
            xyzi.insert(xyzi.end(), {x, y, -1.7F, 0.5F});
        }
        char name[32];
        std::snprintf(name, sizeof(name), "%06d.bin", scan);
        std::ofstream(sequence / "velodyne" / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(xyzi.data()),
                   static_cast<std::streamsize>(xyzi.size() * sizeof(float)));
        times << 0.1 * scan << "\n";
    }
    return sequence;
}

/** Titles of the windows that the viewer shows a few seconds after it was given a rawlog. */
std::vector<std::string> windowsOf(const std::string& rawlog) {
    test::VirtualDisplay display;
    fs::create_directories(display.home() / ".RawLogViewer");
    test::writeText(display.home() / ".RawLogViewer/config.cfg", "[tips]\nshow = 0\n");
    display.start("RawLogViewer", {rawlog});
    display.waitFor("RawlogViewer");
    sleep(3);
    return display.windows();
}

TEST(RawLogViewer, OpensTheRawlogsWithoutADialog) {
    DELIO_NEED_PROGRAMS("RawLogViewer")
    const test::TemporaryFolder folder;
    const auto sequence = smallSequence(folder);
    const std::vector<std::string> mainWindowOnly = {"RawlogViewer - Part of the MRPT project"};
    for (const bool embed : {false, true}) {
        const std::string rawlog = folder / (embed ? "embedded.rawlog" : "external.rawlog");
        std::vector<std::string> arguments = {"-i", sequence, "-o", rawlog};
        if (embed) arguments.emplace_back("--embed");
        ASSERT_EQ(test::runTool("kitti2rawlog", arguments).exitCode, 0);
        EXPECT_EQ(windowsOf(rawlog), mainWindowOnly) << rawlog;
    }
    if (test::isInstalled(test::toolPath("synth2rawlog"))) {
        const std::string synthetic = folder / "synthetic.rawlog";
        ASSERT_EQ(test::runTool("synth2rawlog", {"-o", synthetic, "--scene", "urban", "--scans",
                                                 "3", "--sensor", "vlp16"})
                      .exitCode,
                  0);
        EXPECT_EQ(windowsOf(synthetic), mainWindowOnly);
    }
    // That a dialog would be seen: a compressed rawlog makes the viewer stumble over its progress.
    const std::string compressed = folder / "compressed.rawlog";
    test::runTool("sh", {"-c", "gzip -c '" + (folder / "external.rawlog").string() + "' >'" +
                                   compressed + "'"});
    EXPECT_GT(windowsOf(compressed).size(), 1U);
}
}  // namespace
