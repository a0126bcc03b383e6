#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "command.h"
#include "delio/io/trajectory.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;
namespace fs = std::filesystem;

const std::string kTr = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

/** A straight drive, z forward, as cam0 has it; 0.1 s between poses. */
io::Trajectory cameraDrive(double step_m, std::size_t count) {
    io::Trajectory drive;
    for (std::size_t i = 0; i < count; ++i) {
        const auto n = static_cast<double>(i);
        drive.poses.emplace_back(0, 0, step_m * n);
        drive.stamps_s.push_back(0.1 * n);
    }
    return drive;
}

/** The same, x forward, as a LiDAR has it. */
io::Trajectory lidarDrive(double step_m, std::size_t count) {
    io::Trajectory drive = cameraDrive(step_m, count);
    for (auto& pose : drive.poses) pose = CPose3D(pose.z(), 0, 0);
    return drive;
}

/** Rows of a tsv as cells. */
std::vector<std::vector<std::string>> tsv(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, '\t');) rows.back().push_back(cell);
    }
    return rows;
}

class DelioEval : public testing::Test {
 protected:
    /** A drive of 250 m, an estimate that is 1 % too long, and the same in the LiDAR frame. */
    void SetUp() override {
        io::writeKitti(cameraDrive(0.5, 501), folder_ / "ref.txt");
        io::writeKitti(cameraDrive(0.505, 501), folder_ / "est.txt");
        io::writeKitti(lidarDrive(0.505, 501), folder_ / "lidar.txt");
        test::writeText(folder_ / "calib.txt", kTr);
    }

    std::string in(const std::string& name) const { return folder_ / name; }

    test::CommandResult eval(std::vector<std::string> arguments) const {
        return test::runTool("delio-eval", arguments);
    }
    test::CommandResult tsvOf(const std::string& ref, const std::string& est) const {
        return eval({"--ref", in(ref), "--est", in(est), "--format", "tsv"});
    }

    /** A failed run: its exit code, nothing on stdout, and one line that holds `words`. */
    void expectFailure(const test::CommandResult& result, int exitCode, const std::string& words) {
        EXPECT_EQ(result.exitCode, exitCode);
        EXPECT_EQ(result.out, "");
        EXPECT_TRUE(test::isOneLine(result.err)) << result.err;
        EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    }

    test::TemporaryFolder folder_;
};

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
    expectFailure(tsvOf("truth", "none"), 1, "no pose file");
    expectFailure(tsvOf("truth", "est.txt"), 1, "is no folder");
    expectFailure(tsvOf("ref.txt", "mine"), 1, "trajectory_kitti.txt");
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
    EXPECT_NE(part.err.find("10 of the reference have no partner"), std::string::npos) << part.err;
    expectFailure(tsvOf("ref.txt", "part_tum.txt"), 1, "has 491 poses, the reference 501");

    for (auto& t : estimate.stamps_s) t += 1000;
    io::writeTum(estimate, in("other_clock.txt"));
    expectFailure(tsvOf("ref_tum.txt", "other_clock.txt"), 1, "clock");

    test::writeText(folder_ / "unsorted.txt", "1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n");
    expectFailure(tsvOf("ref_tum.txt", "unsorted.txt"), 1, "sort the file");
    test::writeText(folder_ / "twice.txt", "# t x y z\n1 0 0 0 0 0 0 1 \n1 0 0 0 0 0 0 1\n");
    expectFailure(tsvOf("ref_tum.txt", "twice.txt"), 1, "once more; remove one");
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
        "leave --calib out");
    expectFailure(tsvOf("lidar.txt", "est.txt"), 1, "same frame");
    test::writeText(folder_ / "no_tr.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    expectFailure(
        eval({"--ref", in("ref.txt"), "--est", in("lidar.txt"), "--calib", in("no_tr.txt")}), 1,
        "no Tr");
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
    expectFailure(tsvOf("ref.txt", "nan.txt"), 1, "not a finite number");
    test::writeText(folder_ / "bent.txt", "1 0 0 0 0 1.1 0 0 0 0 1 0\n");
    expectFailure(tsvOf("ref.txt", "bent.txt"), 1, "not a rotation");
}

TEST_F(DelioEval, WritesAReportAndKeepsWhatIsThere) {
    const auto report = [&](const std::string& name, const std::string& more = "--verbose") {
        return eval({"--ref", in("ref.txt"), "--est", in("est.txt"), "--format", "tsv", "-o",
                     in(name), more});
    };
    const auto result = report("deep/report");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(test::readText(in("deep/report/metrics.tsv")), result.out);
    const auto lengths = tsv(test::readText(in("deep/report/lengths.tsv")));
    ASSERT_EQ(lengths.size(), 9U);
    EXPECT_EQ(lengths[1][3], "30");
    EXPECT_NEAR(std::stod(lengths[1][4]), 1.005, 1e-8);
    EXPECT_EQ(lengths[3][4], "-");

    const std::string page = test::readText(in("deep/report/report.html"));
    EXPECT_NE(page.find("1.004"), std::string::npos);  // translation [%]
    std::size_t pictures = 0;
    for (std::size_t at = 0; (at = page.find("src=\"data:image/svg+xml", at)) != std::string::npos;
         ++at)
        ++pictures;
    std::size_t drawn = 0;
    for (const auto& name : test::namesIn(folder_ / "deep/report/plots")) {
        const fs::path file = folder_ / "deep/report/plots" / name;
        if (file.extension() != ".svg") continue;
        ++drawn;
        for (const char* other : {".png", ".dat", ".gp"})
            EXPECT_TRUE(fs::exists(fs::path(file).replace_extension(other))) << name << other;
    }
    EXPECT_EQ(drawn, 10U);  // trajectory, height, 2 over length, speed, time, in histograms
    EXPECT_EQ(pictures, drawn);
    // Nothing is fetched, from the network or from the folder.
    for (const char* link : {"src=\"http", "href=\"http", "url(", "<script", "<link"})
        EXPECT_EQ(page.find(link), std::string::npos) << link;
    EXPECT_EQ(test::namesIn(folder_ / "deep/report").size(), 44U);  // and no partial one

    expectFailure(report("deep/report"), 1, "--force");
    EXPECT_EQ(report("deep/report", "--force").exitCode, 0);
    fs::create_directory(folder_ / "bare");
    EXPECT_EQ(report("bare").exitCode, 0);
    expectFailure(report("ref.txt", "--force"), 1, "is a file");
    const auto unwritable = report("ref.txt/report", "--force");
    expectFailure(unwritable, 1, "cannot make folder");
}

TEST_F(DelioEval, AReportThatCannotBeMadeChangesNothing) {
    const auto report = [&](const std::string& est) {
        return eval({"--ref", in("ref.txt"), "--est", in(est), "-o", in("report"), "--force"});
    };
    ASSERT_EQ(report("est.txt").exitCode, 0);
    test::writeText(folder_ / "report/mine.txt", "stays");
    const auto before = test::readText(folder_ / "report/report.html");
    expectFailure(report("missing.txt"), 1, "no such file");
    const std::string path = getenv("PATH");
    setenv("PATH", folder_.path().c_str(), 1);  // no gnuplot there
    const auto without = report("est.txt");
    const auto fresh = eval({"--ref", in("ref.txt"), "--est", in("est.txt"), "-o", in("fresh")});
    setenv("PATH", path.c_str(), 1);
    expectFailure(without, 1, "gnuplot-nox");
    expectFailure(fresh, 1, "gnuplot-nox");
    EXPECT_FALSE(fs::exists(folder_ / "fresh"));
    EXPECT_EQ(test::readText(folder_ / "report/report.html"), before);
    EXPECT_EQ(test::readText(folder_ / "report/mine.txt"), "stays");
    EXPECT_FALSE(fs::exists(folder_ / "report/.partial-report"));
    ASSERT_EQ(report("est.txt").exitCode, 0);
    EXPECT_EQ(test::readText(folder_ / "report/mine.txt"), "stays");
}

TEST_F(DelioEval, AReportTakesAnyName) {
    const std::string name = "<b>it's \"q\" & c_d `touch x` \\n";
    fs::copy(in("ref.txt"), in("se q'&.txt"));
    const auto result = eval({"--ref", in("se q'&.txt"), "--est", name + "=" + in("est.txt"),
                              "--est", "truth=" + in("ref.txt"), "-o", in("report")});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto page = test::readText(in("report/report.html"));
    EXPECT_NE(page.find("&lt;b&gt;it's &quot;q&quot; &amp; c_d `touch x`"), std::string::npos);
    EXPECT_EQ(page.find("<b>it"), std::string::npos);
    EXPECT_NE(page.find("Sequence se q'&amp;<"), std::string::npos);
    EXPECT_TRUE(fs::exists(folder_ / "report/plots/se_q___trajectory.png"));
}

TEST_F(DelioEval, AShortOrStandingDriveHasAReportToo) {
    io::writeKitti(cameraDrive(0, 20), in("standing.txt"));
    io::writeKitti(cameraDrive(0, 1), in("single.txt"));
    io::writeKitti(cameraDrive(0.5, 41), in("short.txt"));
    for (const std::string drive : {"standing", "single", "short"}) {
        const auto result = eval({"--ref", in(drive + ".txt"), "--est", in(drive + ".txt"), "-o",
                                  in("report-" + drive)});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_NE(test::readText(in("report-" + drive + "/report.html")).find("--lengths"),
                  std::string::npos);
    }
}

TEST_F(DelioEval, MarksPredictedScansAndSkipsUnusedOnes) {
    fs::create_directory(folder_ / "run");
    // Every second of 60 scans; scans 20 and 22 were predicted.
    io::writeKitti(cameraDrive(1, 60), in("whole.txt"));
    io::writeKitti(cameraDrive(2.02, 30), in("run/trajectory_kitti.txt"));
    std::string table = "scan,stamp_s,predicted,reason\n";
    for (int i = 0; i < 60; i += 2)
        table += std::to_string(i) + "," + std::to_string(0.1 * i) + "," +
                 (i == 20 || i == 22 ? "1,too few, of all" : "0,") + "\n";
    test::writeText(folder_ / "run/scans.csv", table);
    const auto result = eval({"--ref", in("whole.txt"), "--est", in("run"), "--lengths", "10,20",
                              "-o", in("report"), "--format", "tsv"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_NE(result.err.find("30 of 60 scans"), std::string::npos) << result.err;
    EXPECT_NEAR(std::stod(tsv(result.out)[1][7]), 0.02, 1e-8);
    const auto data = test::readText(in("report/plots/whole_translation_over_time.dat"));
    EXPECT_NE(data.find("# predicted\n2 0.02\n2.2 0.02\n"), std::string::npos) << data;
    EXPECT_NE(test::readText(in("report/report.html")).find("<td>2</td></tr>"), std::string::npos);

    test::writeText(folder_ / "run/scans.csv", "scan,stamp_s,predicted\n0,0,0\n");
    const auto unlike = eval({"--ref", in("whole.txt"), "--est", in("run")});
    EXPECT_EQ(unlike.exitCode, 1);
    EXPECT_NE(unlike.err.find("has 1 scans for the 30 poses"), std::string::npos) << unlike.err;
    EXPECT_NE(unlike.err.find("has 30 poses, the reference 60"), std::string::npos) << unlike.err;
}

TEST_F(DelioEval, ScoresAFolderOfRuns) {
    for (const char* name : {"truth", "runs", "runs/00", "runs/01"})
        fs::create_directory(folder_ / name);
    for (const std::string nn : {"00", "01"}) {
        io::writeKitti(cameraDrive(0.5, 301), in("truth/" + nn + ".txt"));
        io::writeKitti(lidarDrive(0.505, 301), in("runs/" + nn + "/trajectory_kitti.txt"));
        io::writeKitti(cameraDrive(0.505, 301), in("runs/" + nn + "/trajectory_kitti_cam0.txt"));
    }
    const auto result =
        eval({"--ref", in("truth"), "--est", in("runs"), "--format", "tsv", "-o", in("report")});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto rows = tsv(result.out);
    ASSERT_EQ(rows.size(), 4U) << result.out;
    EXPECT_EQ(rows[2][1], "01");
    EXPECT_TRUE(fs::exists(folder_ / "report/plots/01_height.svg"));
    EXPECT_TRUE(fs::exists(folder_ / "report/plots/all_translation_over_length.svg"));
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
    expectFailure(with("--est", in("est.txt")), 2, "called 'est'");
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
}  // namespace
