#include <tuple>

#include "delio_eval_fixture.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using test::cameraDrive, test::lidarDrive, test::tsv, test::DelioEval;
namespace fs = std::filesystem;

TEST_F(DelioEval, WritesOneRowOfTheContractsColumns) {
    const auto result =
        eval({"--ref", in("ref.txt"), "--est", "mine=" + in("est.txt"), "--format", "tsv"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const auto rows = tsv(result.out);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0],
              (std::vector<std::string>{"name", "sequence", "length_m", "segments", "t_percent",
                                        "r_deg_per_100m", "ape_m", "rpe_m", "rpe_deg"}));
    EXPECT_EQ(rows[1][0], "mine");
    EXPECT_EQ(rows[1][1], "ref");
    EXPECT_EQ(rows[1][2], "250.000000000");
    EXPECT_EQ(rows[1][3], "40");  // 30 of 100 m, 10 of 200 m
    EXPECT_NEAR(std::stod(rows[1][4]), (30 * 1.005 + 10 * 1.0025) / 40, 1e-8);
    EXPECT_NEAR(std::stod(rows[1][5]), 0, 1e-8);
    EXPECT_NEAR(std::stod(rows[1][7]), 0.005, 1e-8);
}

TEST_F(DelioEval, ShowsATableUnlessToldOtherwise) {
    const auto result = eval({"--ref", in("ref.txt"), "--est", in("est.txt"), "--est",
                              "truth=" + in("ref.txt"), "--verbose"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.out.find("rotation [deg/100 m]"), std::string::npos);
    EXPECT_NE(result.out.find("\nest "), std::string::npos);
    EXPECT_NE(result.out.find("\ntruth "), std::string::npos);
    EXPECT_NE(result.err.find("501 poses"), std::string::npos);
}

TEST_F(DelioEval, DeltaSpansPoses) {
    const auto result =
        eval({"--ref", in("ref.txt"), "--est", in("est.txt"), "--format", "tsv", "--delta", "20"});
    EXPECT_NEAR(std::stod(tsv(result.out).at(1).at(7)), 0.1, 1e-8);
}

TEST_F(DelioEval, ScoresFoldersAndAverages) {
    for (const char* name : {"truth", "mine"}) fs::create_directory(folder_ / name);
    io::writeKitti(cameraDrive(0.5, 501), in("truth/00.txt"));
    io::writeKitti(cameraDrive(0.5, 301), in("truth/01.txt"));
    io::writeKitti(cameraDrive(0.5, 301), in("truth/02.txt"));
    io::writeKitti(cameraDrive(0.505, 501), in("mine/00.txt"));
    io::writeKitti(cameraDrive(0.515, 301), in("mine/01.txt"));
    io::writeKitti(cameraDrive(0.5, 301), in("mine/11.txt"));  // no truth
    const auto result = tsvOf("truth", "mine/");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto rows = tsv(result.out);
    ASSERT_EQ(rows.size(), 4U) << result.out;
    EXPECT_EQ(rows[1][0], "mine");
    EXPECT_EQ(rows[1][1], "00");
    EXPECT_EQ(rows[2][1], "01");
    EXPECT_EQ(rows[3][1], "avg");
    EXPECT_NEAR(std::stod(rows[3][4]), (std::stod(rows[1][4]) + std::stod(rows[2][4])) / 2, 1e-8);
    EXPECT_EQ(rows[3][2], "400.000000000");

    const auto unlike = eval({"--ref", in("truth"), "--est", in("mine"), "--est", in("truth")});
    EXPECT_EQ(unlike.exitCode, 0);
    EXPECT_NE(unlike.err.find("different sequences"), std::string::npos) << unlike.err;

    fs::create_directory(folder_ / "none");
    expectFailure(tsvOf("truth", "none"), 1, "no NN.txt in common");
    expectFailure(tsvOf("truth", "est.txt"), 1, "is not a folder");
    expectFailure(tsvOf("ref.txt", "mine"), 1, "trajectory_kitti.txt");
}

// Of files, which others have named.
TEST_F(DelioEval, NamesOfFilesBreakNoTable) {
    for (const std::string folder : {"odd", "odd-est"}) {
        fs::create_directory(folder_ / folder);
        io::writeKitti(cameraDrive(0.5, 501), in(folder + "/a\nb\tc.txt"));
    }
    const auto found = tsvOf("odd", "odd-est");
    ASSERT_EQ(found.exitCode, 0) << found.err;
    const auto rows = tsv(found.out);
    ASSERT_EQ(rows.size(), 3U) << found.out;
    for (const auto& row : rows) EXPECT_EQ(row.size(), 9U) << found.out;
    EXPECT_EQ(rows[1][1], "a?b?c");
    const auto alone = tsvOf("ref.txt", "odd-est/a\nb\tc.txt");
    ASSERT_EQ(alone.exitCode, 0) << alone.err;
    EXPECT_EQ(tsv(alone.out)[1][0], "a?b?c");
}

TEST_F(DelioEval, TakesTheRightFileOfDelioSlamsFolder) {
    fs::create_directory(folder_ / "run");
    io::writeKitti(lidarDrive(0.505, 501), in("run/trajectory_kitti.txt"));
    expectFailure(tsvOf("ref.txt", "run"), 1, "--calib");
    io::writeKitti(cameraDrive(0.505, 501), in("run/trajectory_kitti_cam0.txt"));
    const auto asWritten = tsvOf("ref.txt", "run");
    ASSERT_EQ(asWritten.exitCode, 0) << asWritten.err;
    EXPECT_EQ(tsv(asWritten.out)[1][0], "run");
    const auto converted = eval({"--ref", in("ref.txt"), "--est", in("run"), "--format", "tsv",
                                 "--calib", in("calib.txt")});
    ASSERT_EQ(converted.exitCode, 0) << converted.err;
    EXPECT_EQ(converted.out, asWritten.out);
}

TEST_F(DelioEval, MatchesTumFilesByTime) {
    auto reference = cameraDrive(0.5, 501), estimate = cameraDrive(0.505, 501);
    io::writeTum(reference, in("ref_tum.txt"));
    for (auto& t : estimate.stamps_s) t += 0.004;
    io::writeTum(estimate, in("est_tum.txt"));
    const auto byRow = tsvOf("ref.txt", "est.txt");
    const auto byTime = tsvOf("ref_tum.txt", "est_tum.txt");
    ASSERT_EQ(byTime.exitCode, 0) << byTime.err;
    EXPECT_EQ(byTime.err, "");
    EXPECT_EQ(tsv(byTime.out)[1][4], tsv(byRow.out)[1][4]);
    EXPECT_EQ(tsvOf("ref_tum.txt", "est.txt").exitCode, 0);

    estimate.poses.erase(estimate.poses.begin(), estimate.poses.begin() + 10);
    estimate.stamps_s.erase(estimate.stamps_s.begin(), estimate.stamps_s.begin() + 10);
    io::writeTum(estimate, in("part_tum.txt"));
    const auto part = tsvOf("ref_tum.txt", "part_tum.txt");
    EXPECT_EQ(part.exitCode, 0);
    EXPECT_NE(part.err.find("10 of the reference have no counterpart"), std::string::npos)
        << part.err;
    expectFailure(tsvOf("ref.txt", "part_tum.txt"), 1, "has 491 poses, the reference 501");

    for (auto& t : estimate.stamps_s) t += 1000;
    io::writeTum(estimate, in("other_clock.txt"));
    expectFailure(tsvOf("ref_tum.txt", "other_clock.txt"), 1, "clock");

    test::writeText(folder_ / "unsorted.txt", "1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n");
    expectFailure(tsvOf("ref_tum.txt", "unsorted.txt"), 1, "sort the file");
    test::writeText(folder_ / "twice.txt", "# t x y z\n1 0 0 0 0 0 0 1 \n1 0 0 0 0 0 0 1\n");
    expectFailure(tsvOf("ref_tum.txt", "twice.txt"), 1, "duplicate stamp; remove one");
}

TEST_F(DelioEval, AShortDriveHasNoFigureButAHint) {
    io::writeKitti(cameraDrive(0.5, 41), in("short.txt"));
    const auto result = tsvOf("short.txt", "short.txt");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto row = tsv(result.out)[1];
    EXPECT_EQ(row[3], "0");
    EXPECT_EQ(row[4], "-");
    EXPECT_EQ(row[5], "-");
    EXPECT_NE(row[6], "-");
    EXPECT_TRUE(test::isOneLine(result.err)) << result.err;
    ASSERT_NE(result.err.find("--lengths 2,4,6,8"), std::string::npos) << result.err;
    const auto again = eval({"--ref", in("short.txt"), "--est", in("short.txt"), "--format", "tsv",
                             "--lengths", "2,4,6,8"});
    EXPECT_EQ(again.err, "");
    EXPECT_NE(tsv(again.out)[1][4], "-");
}

TEST_F(DelioEval, TheWrongFrameIsNamed) {
    expectFailure(tsvOf("ref.txt", "lidar.txt"), 1, "give --calib");
    const auto calibrated = eval({"--ref", in("ref.txt"), "--est", in("lidar.txt"), "--calib",
                                  in("calib.txt"), "--format", "tsv"});
    ASSERT_EQ(calibrated.exitCode, 0) << calibrated.err;
    EXPECT_EQ(tsv(calibrated.out)[1][4], tsv(tsvOf("ref.txt", "est.txt").out)[1][4]);
    expectFailure(
        eval({"--ref", in("ref.txt"), "--est", in("est.txt"), "--calib", in("calib.txt")}), 1,
        "leave out --calib");
    expectFailure(tsvOf("lidar.txt", "est.txt"), 1, "same frame");
    test::writeText(folder_ / "no_tr.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    expectFailure(
        eval({"--ref", in("ref.txt"), "--est", in("lidar.txt"), "--calib", in("no_tr.txt")}), 1,
        "no Tr");
}

TEST_F(DelioEval, TheWrongFrameIsNamedOfShortPathsTooOrAWarningSaysThatItIsNotKnown) {
    const auto short_ = [&](double step_m, std::size_t count) {
        io::writeKitti(cameraDrive(step_m, count), in("short.txt"));
        io::writeKitti(lidarDrive(step_m, count), in("short_lidar.txt"));
        return tsvOf("short.txt", "short_lidar.txt");
    };
    expectFailure(short_(0.5, 6), 1, "give --calib");
    expectFailure(short_(0.05, 20), 1, "give --calib");
    const auto unknown = short_(0.01, 5);
    EXPECT_EQ(unknown.exitCode, 0);
    EXPECT_NE(unknown.err.find("too short to check that both are in the same frame"),
              std::string::npos)
        << unknown.err;
}

TEST_F(DelioEval, TheHeadOfKittis00IsAWarning) {
    DELIO_NEED_DATA("kitti/poses/00.txt");
    const auto lines = test::linesOf(test::readText(test::dataFolder() / "kitti/poses/00.txt"));
    for (const auto& [name, begin, warned] :
         {std::tuple("head.txt", 0, true), std::tuple("later.txt", 100, false)}) {
        std::string text;
        for (int i = 0; i < 10; ++i) text += lines.at(static_cast<std::size_t>(begin + i)) + "\n";
        test::writeText(in(name), text);
        const auto result = tsvOf(name, name);
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_EQ(result.err.find("first 16 scans of sequence 00") != std::string::npos, warned)
            << result.err;
    }
}

TEST_F(DelioEval, BadFilesEndInOneLine) {
    io::writeKitti(cameraDrive(0.5, 500), in("fewer.txt"));
    test::writeText(folder_ / "empty.txt", "");
    test::writeText(folder_ / "text.txt", "1 0 0 0 0 1 0 0 0 0 1 0\nhello\n");
    expectFailure(tsvOf("ref.txt", "fewer.txt"), 1, "has 500 poses, the reference 501");
    expectFailure(tsvOf("ref.txt", "missing.txt"), 1, "no such file");
    expectFailure(tsvOf("missing.txt", "est.txt"), 1, "no such file");
    expectFailure(tsvOf("ref.txt", "empty.txt"), 1, "empty");
    expectFailure(tsvOf("ref.txt", "text.txt"), 1, "line 2");
    test::writeText(folder_ / "nan.txt", "1 0 0 nan 0 1 0 0 0 0 1 0\n");
    expectFailure(tsvOf("ref.txt", "nan.txt"), 1, "expected a finite number");
    test::writeText(folder_ / "bent.txt", "1 0 0 0 0 1.1 0 0 0 0 1 0\n");
    expectFailure(tsvOf("ref.txt", "bent.txt"), 1, "not a rotation");
}

TEST_F(DelioEval, ABadCommandLineIsTwo) {
    const auto with = [&](const std::string& option, const std::string& value) {
        return eval({"--ref", in("ref.txt"), "--est", in("est.txt"), option, value});
    };
    for (const char* lengths :
         {"", "abc", "100,,200", "100,", "200,100", "-5", "0", "1e999", "nan"})
        expectFailure(with("--lengths", lengths), 2, "lengths");
    for (const char* delta : {"0", "-1", "1.5", "x"})
        expectFailure(with("--delta", delta), 2, "delta");
    expectFailure(with("--format", "xml"), 2, "format");
    expectFailure(with("--nonsense", "1"), 2, "nonsense");
    expectFailure(with("--est", in("est.txt")), 2, "the name 'est'");
    expectFailure(with("--est", "=x"), 2, "NAME");
    expectFailure(eval({"--ref", in("ref.txt")}), 2, "required");
    expectFailure(eval({}), 2, "required");
}

TEST_F(DelioEval, HelpAndVersionSucceed) {
    const auto help = eval({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_NE(help.out.find("--lengths"), std::string::npos);
    EXPECT_NE(help.out.find("deg/100 m"), std::string::npos);
    const auto version = eval({"--version"});
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_TRUE(test::isOneLine(version.out));
}
TEST_F(DelioEval, WarnsOfRowsAfterTheLastScan) {
    fs::create_directory(folder_ / "run");
    io::writeKitti(cameraDrive(0.505, 3), in("run/trajectory_kitti.txt"));
    const auto errorsFor = [&](const std::string& scans) {
        test::writeText(in("run/scans.csv"), "scan,stamp_s,predicted\n" + scans);
        const auto result = tsvOf("ref.txt", "run");
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.err;
    };
    const std::string asked = "reference has 501 rows, but the last scan is number 2";
    EXPECT_NE(errorsFor("0,0,0\n1,0.1,0\n2,0.2,0\n").find("warning: "), std::string::npos);
    EXPECT_NE(errorsFor("0,0,0\n1,0.1,0\n2,0.2,0\n").find(asked), std::string::npos);
    // Every 250th scan of the whole drive was used.
    EXPECT_NE(errorsFor("0,0,0\n250,25,0\n500,50,0\n").find("the 3 of 501 scans used"),
              std::string::npos);
}
}  // namespace
