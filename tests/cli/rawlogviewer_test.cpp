// RawLogViewer opens the rawlogs that our tools write, without a dialog, and shows their points;
// under Xvfb.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
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

const std::vector<std::string> kMainWindowOnly = {"RawlogViewer - Part of the MRPT project"};

/** The viewer a few seconds after it was given a rawlog, started in `folder`. */
void startIn(const fs::path& folder, const std::string& rawlog, test::VirtualDisplay& display) {
    fs::create_directories(display.home() / ".RawLogViewer");
    test::writeText(display.home() / ".RawLogViewer/config.cfg", "[tips]\nshow = 0\n");
    display.start("sh", {"-c", "cd \"$0\" && exec RawLogViewer \"$1\"", folder, rawlog});
    display.waitFor(kMainWindowOnly.front());
    sleep(3);
}

/** Titles of the windows that the viewer shows. */
std::vector<std::string> windowsOf(const std::string& rawlog) {
    test::VirtualDisplay display;
    startIn("/", rawlog, display);
    return display.windows();
}

/** What a click on a scan does. The 3D view has a grey background as soon as a scan is shown, on
 *  which points are black. */
struct AfterClick {
    std::vector<std::string> windows;
    double greyShare = 0;  //!< of the 3D view
    int blackPixels = 0;   //!< in it

    bool hasEffect() const { return greyShare > 0.5 || hasException(); }
    bool hasException() const {
        return std::find(windows.begin(), windows.end(), "Exception") != windows.end();
    }
};

AfterClick look(test::VirtualDisplay& display) {
    AfterClick found;
    found.windows = display.windows();
    auto picture = display.screenshot();
    int grey = 0, all = 0;
    for (unsigned y = 450; y < 680; ++y)
        for (unsigned x = 420; x < 1190; ++x, ++all) {
            const int shade = picture.at<uint8_t>(x, y, 0);
            grey += std::abs(shade - 102) < 12;
            found.blackPixels += shade < 20;
        }
    found.greyShare = static_cast<double>(grey) / all;
    return found;
}

AfterClick clickOnAScan(const fs::path& folder, const std::string& rawlog) {
    test::VirtualDisplay display;
    startIn(folder, rawlog, display);
    // A click has no effect while the viewer loads the rawlog, and a busy machine makes it slow.
    constexpr int kClicks = 10;
    AfterClick found;
    for (int click = 0; click < kClicks && !found.hasEffect(); ++click) {
        // At first the window is too small to have the list in it.
        test::runTool("xdotool",
                      {"search", "--name", "RawlogViewer - Part", "windowsize", "1200", "850"});
        sleep(2);
        test::runTool("xdotool", {"mousemove", "60", "140", "click", "1"});
        sleep(4);
        found = look(display);
    }
    return found;
}

TEST(RawLogViewer, OpensTheRawlogsWithoutADialog) {
    DELIO_NEED_PROGRAMS("RawLogViewer")
    const test::TemporaryFolder folder;
    const auto sequence = smallSequence(folder);
    for (const bool embed : {false, true}) {
        const std::string rawlog = folder / (embed ? "embedded.rawlog" : "external.rawlog");
        std::vector<std::string> arguments = {"-i", sequence, "-o", rawlog};
        if (embed) arguments.emplace_back("--embed");
        ASSERT_EQ(test::runTool("kitti2rawlog", arguments).exitCode, 0);
        EXPECT_EQ(windowsOf(rawlog), kMainWindowOnly) << rawlog;
    }
    if (test::isInstalled(test::toolPath("synth2rawlog"))) {
        const std::string synthetic = folder / "synthetic.rawlog";
        ASSERT_EQ(test::runTool("synth2rawlog", {"-o", synthetic, "--scene", "urban", "--scans",
                                                 "3", "--sensor", "vlp16"})
                      .exitCode,
                  0);
        EXPECT_EQ(windowsOf(synthetic), kMainWindowOnly);
    }
    // That a dialog would be seen: a compressed rawlog makes the viewer stumble over its progress.
    const std::string compressed = folder / "compressed.rawlog";
    test::runTool("sh", {"-c", "gzip -c '" + (folder / "external.rawlog").string() + "' >'" +
                                   compressed + "'"});
    EXPECT_GT(windowsOf(compressed).size(), 1U);
}

// compatibility.md: from anywhere where the points are in the rawlog, in its folder where not.
TEST(RawLogViewer, AClickOnAScanShowsItsPoints) {
    DELIO_NEED_PROGRAMS("RawLogViewer", "xdotool")
    const test::TemporaryFolder folder;
    const auto sequence = smallSequence(folder);
    const fs::path external = folder / "external.rawlog", embedded = folder / "embedded.rawlog";
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", sequence, "-o", external}).exitCode, 0);
    ASSERT_EQ(test::runTool("kitti2rawlog", {"-i", sequence, "-o", embedded, "--embed"}).exitCode,
              0);
    constexpr int kPoints = 400;
    for (const auto& found :
         {clickOnAScan(folder.path(), external.filename()), clickOnAScan("/", embedded)}) {
        EXPECT_EQ(found.windows, kMainWindowOnly);
        EXPECT_GT(found.greyShare, 0.5);
        EXPECT_GT(found.blackPixels, kPoints);
    }
    // MRPT 2.5.8 loses a '/' of the folder: where this no longer holds, compatibility.md is wrong.
    EXPECT_TRUE(clickOnAScan("/", external).hasException());
}
}  // namespace
