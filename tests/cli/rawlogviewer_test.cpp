// RawLogViewer opens what kitti2rawlog writes, without a dialog; under Xvfb.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "command.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

bool installed(const std::string& program) {
    return test::runTool("sh", {"-c", "command -v " + program}).exitCode == 0;
}

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
std::vector<std::string> windowsOf(const std::string& rawlog, const test::TemporaryFolder& folder) {
    const fs::path home = folder / "home";
    fs::create_directories(home / ".RawLogViewer");
    test::writeText(home / ".RawLogViewer/config.cfg", "[tips]\nshow = 0\n");
    const auto shown =
        test::runTool("sh", {"-c", "HOME='" + home.string() +
                                       "' xvfb-run -a -s '-screen 0 1280x900x24' sh -c \"" +
                                       "RawLogViewer '" + rawlog +
                                       "' >/dev/null 2>&1 & viewer=\\$!; sleep 5; "
                                       "xwininfo -root -tree; kill \\$viewer\""});
    std::vector<std::string> titles;
    std::istringstream lines(shown.out);
    for (std::string line; std::getline(lines, line);) {
        const auto begin = line.find('"'), end = line.find("\": (");
        // wxWidgets keeps small windows of its own, 10x10 and 200x200, that nobody sees.
        const bool seen = line.find(" 10x10+") == line.npos && line.find(" 200x200+") == line.npos;
        if (begin != line.npos && end != line.npos && seen)
            titles.push_back(line.substr(begin + 1, end - begin - 1));
    }
    return titles;
}

TEST(RawLogViewer, OpensTheRawlogsWithoutADialog) {
    for (const char* program : {"RawLogViewer", "xvfb-run", "xwininfo"})
        if (!installed(program)) {
            if (test::dataIsRequired()) FAIL() << program << " is not installed";
            GTEST_SKIP() << program << " is not installed";
        }
    const test::TemporaryFolder folder;
    const auto sequence = smallSequence(folder);
    const std::vector<std::string> mainWindowOnly = {"RawlogViewer - Part of the MRPT project"};
    for (const bool embed : {false, true}) {
        const std::string rawlog = folder / (embed ? "embedded.rawlog" : "external.rawlog");
        std::vector<std::string> arguments = {"-i", sequence, "-o", rawlog};
        if (embed) arguments.emplace_back("--embed");
        ASSERT_EQ(test::runTool("kitti2rawlog", arguments).exitCode, 0);
        EXPECT_EQ(windowsOf(rawlog, folder), mainWindowOnly) << rawlog;
    }
    // That a dialog would be seen: a compressed rawlog makes the viewer stumble over its progress.
    const std::string compressed = folder / "compressed.rawlog";
    test::runTool("sh", {"-c", "gzip -c '" + (folder / "external.rawlog").string() + "' >'" +
                                   compressed + "'"});
    EXPECT_GT(windowsOf(compressed, folder).size(), 1U);
}
}  // namespace
