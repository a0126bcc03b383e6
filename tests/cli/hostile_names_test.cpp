// Labels and names in files of others: nothing of them is a command to the terminal.
#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>

#include "command.h"
#include "test_data.h"

namespace {
using namespace delio;

TEST(HostileNames, AreNoCommandsToTheTerminal) {
    const test::TemporaryFolder folder;
    const std::string rawlog = folder / "a.rawlog";
    {
        mrpt::io::CFileOutputStream out(rawlog);
        mrpt::obs::CObservationPointCloud scan;
        scan.sensorLabel = "a\x1B[2J";
        scan.setAsExternalStorage(
            "\x1B]0;title\x07.bin",
            mrpt::obs::CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
        mrpt::serialization::archiveFrom(out) << scan;
    }
    for (const std::string label : {"", "none"}) {
        std::vector<std::string> words = {"-i", rawlog, "-o", folder / "out", "--force"};
        if (!label.empty()) words.insert(words.end(), {"--sensor-label", label});
        const auto run = test::runTool("delio-slam", words);
        EXPECT_EQ(run.exitCode, 1);
        for (const std::string& text : {run.out, run.err})
            EXPECT_TRUE(std::none_of(text.begin(), text.end(), [](unsigned char c) {
                return (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
            })) << text;
        EXPECT_NE(run.err.find(label.empty() ? "'?]0;title?.bin'" : "'a?[2J'"), std::string::npos)
            << run.err;
    }
}

TEST(HostileNames, MakeNoEndlessLines) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.rawlog", "x");
    test::writeText(folder / "a.meta.yaml", std::string(100000, 'k') + ": 1\n");
    const std::string missing(3000, 'm');
    for (const std::string& input : {(folder / "a.rawlog").string(), missing}) {
        const auto run = test::runTool("delio-slam", {"-i", input, "-o", folder / "out"});
        EXPECT_EQ(run.exitCode, 1);
        EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
        EXPECT_LT(run.err.size(), 2200U);
    }
}
}  // namespace
