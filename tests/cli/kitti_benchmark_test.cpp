#include <gtest/gtest.h>

#include <cstdlib>

#include "command.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

/** A tree in KITTI's layout: 00 and 07 with truth, 14 without, 03 without scans. */
class KittiBenchmark : public testing::Test {
 protected:
    void SetUp() override {
        const fs::path tools = fs::path(test::toolPath("delio-slam")).parent_path();
        path_ = getenv("PATH");
        setenv("PATH", (tools.string() + ":" + path_).c_str(), 1);
        fs::create_directories(root() / "poses");
        fs::create_directories(root() / "sequences/03/velodyne");
        for (const std::string nn : {"00", "07", "14"}) {
            const fs::path sequence = root() / "sequences" / nn;
            test::writeSequence(sequence, test::toyScans(nn == "00" ? 12 : 6));
            if (nn == "14")
                fs::remove(sequence / "poses.txt");
            else
                fs::rename(sequence / "poses.txt", root() / "poses" / (nn + ".txt"));
        }
    }
    void TearDown() override { setenv("PATH", path_.c_str(), 1); }

    fs::path root() const { return folder_ / "KITTI root"; }
    fs::path out() const { return folder_ / "the results"; }
    test::CommandResult run(std::vector<std::string> more = {}) const {
        std::vector<std::string> words = {root(), "-o", out(), "--jobs", "2", "--lengths", "2,4"};
        words.insert(words.end(), more.begin(), more.end());
        return test::runTool(test::profileFolder().parent_path() / "scripts/kitti-benchmark",
                             words);
    }

    test::TemporaryFolder folder_;
    std::string path_;
};

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST_F(KittiBenchmark, ScoresDrawsAndGoesOn) {
    const std::vector<std::string> options = {"--", "--set", "scan.vertical_correction_deg=0"};
    const auto first = run(options);
    ASSERT_EQ(first.exitCode, 0) << first.err;
    EXPECT_TRUE(has(first.err, "sequence 03: no scans in")) << first.err;
    EXPECT_TRUE(has(first.err, "sequence 21: no scans in")) << first.err;
    EXPECT_TRUE(has(first.out, "DeLiO accurate  07")) << first.out;
    EXPECT_FALSE(has(first.out, "  14  ")) << first.out;
    for (const char* file :
         {"report/report.html", "figures/trajectory-07-before-and-after.png",
          "figures/trajectory-14.png", "figures/map-07.png", "submission/accurate/14.txt"})
        EXPECT_TRUE(fs::exists(out() / file)) << file;
    EXPECT_EQ(test::linesOf(test::readText(out() / "submission/accurate/14.txt")).size(), 6U);
    EXPECT_FALSE(fs::exists(out() / "submission/accurate/07.txt"));
    const auto table = test::readText(out() / "table.md");
    EXPECT_TRUE(has(table, "| KISS-ICP | 0.50 | 0.15 | 00-10 |")) << table;
    EXPECT_TRUE(has(table, "| 00 07 | measured")) << table;

    // As if it had been stopped before 14.
    fs::remove_all(out() / "accurate/14");
    const auto again = run(options);
    ASSERT_EQ(again.exitCode, 0) << again.err;
    EXPECT_TRUE(has(again.err, "sequence 07, profile accurate: done before")) << again.err;
    EXPECT_TRUE(has(again.err, "sequence 14, profile accurate: begins")) << again.err;
    EXPECT_EQ(again.out, first.out);
}

TEST_F(KittiBenchmark, DrawsOtherProgramsOnASequenceWithoutTruth) {
    const fs::path other = folder_ / "other program";
    fs::create_directories(other);
    fs::copy_file(root() / "poses/07.txt", other / "14.txt");
    fs::copy_file(root() / "poses/07.txt", other / "07.txt");
    const auto result = run({"--sequences", "07 14", "--compare", "another=" + other.string()});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(has(result.out, "another")) << result.out;
    EXPECT_TRUE(fs::exists(out() / "figures/methods.png"));
}

TEST_F(KittiBenchmark, ASequenceThatFailsIsNamedAndTheOthersGoOn) {
    test::writeText(root() / "sequences/00/velodyne/000003.bin", "cut off");
    const auto result = run();
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_TRUE(has(result.err, "sequence 00, profile accurate: failed")) << result.err;
    EXPECT_TRUE(has(result.err, "000003.bin")) << result.err;
    EXPECT_TRUE(has(result.err, "1 runs failed")) << result.err;
    EXPECT_TRUE(has(result.out, "DeLiO accurate  07")) << result.out;
    EXPECT_FALSE(fs::exists(out() / "accurate/00"));
}

TEST_F(KittiBenchmark, AFlagThatItGivesItselfMayBeGivenToo) {
    const auto result = run({"--", "--no-map"});  // it gives --no-map to all sequences but 07
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(fs::exists(out() / "accurate/00/summary.yaml"));
    EXPECT_TRUE(fs::exists(out() / "accurate/07/summary.yaml"));
    EXPECT_FALSE(fs::exists(out() / "accurate/07/map.ply"));
}

TEST_F(KittiBenchmark, ARefusedFirstCallSpoilsNoLaterOne) {
    const auto refused = run({"--", "--threads", "1"});
    EXPECT_EQ(refused.exitCode, 2);
    EXPECT_TRUE(has(refused.err, "--threads after --")) << refused.err;
    const auto later = run();
    EXPECT_EQ(later.exitCode, 0) << later.err;
    EXPECT_TRUE(fs::exists(out() / "table.md"));
}

TEST_F(KittiBenchmark, RowsOfOtherLengthsThanThePublishedOnesAreMarked) {
    const std::string mark = "| measured, kitti-benchmark, **segments of 2,4 m** |";
    const std::string why = "rows of other segments cannot be compared with them";
    const auto table = [&] { return test::readText(out() / "table.md"); };
    ASSERT_EQ(run({"--sequences", "07"}).exitCode, 0);
    EXPECT_TRUE(has(table(), mark) && has(table(), why)) << table();
    // The same results, but KITTI's own lengths: its rows are of the published ones' kind.
    ASSERT_EQ(run({"--sequences", "07", "--lengths", "100,200,300,400,500,600,700,800"}).exitCode,
              0);
    EXPECT_TRUE(has(table(), "| measured, kitti-benchmark |")) << table();
    EXPECT_FALSE(has(table(), why)) << table();
}

TEST_F(KittiBenchmark, BadInput) {
    const std::string script = test::profileFolder().parent_path() / "scripts/kitti-benchmark";
    const auto expect = [&](const std::vector<std::string>& words, int code,
                            const std::string& what) {
        const auto result = test::runTool(script, words);
        EXPECT_EQ(result.exitCode, code) << what;
        EXPECT_TRUE(test::isOneLine(result.err)) << result.err;
        EXPECT_TRUE(has(result.err, what)) << result.err;
    };
    expect({}, 2, "KITTI_ROOT is missing");
    expect({root(), "--jobs", "0"}, 2, "--jobs");
    expect({root(), "--jobs"}, 2, "--jobs needs a value");
    expect({root(), "--fast"}, 2, "unknown option --fast");
    expect({root(), "--sequences", "7"}, 2, "'7' is not a sequence");
    expect({folder_ / "none"}, 1, "no folder 'sequences'");
    EXPECT_EQ(test::runTool(script, {"--help"}).exitCode, 0);
}
}  // namespace
