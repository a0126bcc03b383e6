#include <cstdlib>

#include "delio_eval_fixture.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using test::cameraDrive, test::lidarDrive, test::tsv, test::DelioEval;
namespace fs = std::filesystem;

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
    EXPECT_EQ(drawn, 8U);  // trajectory, height; both errors over length, speed and time
    EXPECT_EQ(pictures, drawn);
    // Nothing is fetched, from the network or from the folder.
    for (const char* link : {"src=\"http", "href=\"http", "url(", "<script", "<link"})
        EXPECT_EQ(page.find(link), std::string::npos) << link;
    EXPECT_EQ(test::namesIn(folder_ / "deep/report").size(), 36U);  // and no partial one

    expectFailure(report("deep/report"), 1, "--force");
    EXPECT_EQ(report("deep/report", "--force").exitCode, 0);
    fs::create_directory(folder_ / "bare");
    EXPECT_EQ(report("bare").exitCode, 0);
    expectFailure(report("ref.txt", "--force"), 1, "is a file");
    const auto unwritable = report("ref.txt/report", "--force");
    expectFailure(unwritable, 1, "cannot create the folder");
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
    EXPECT_NE(unlike.err.find("has 1 scans but there are 30 poses"), std::string::npos)
        << unlike.err;
    EXPECT_NE(unlike.err.find("has 30 poses, the reference 60"), std::string::npos) << unlike.err;
}

TEST_F(DelioEval, AReportLinksToTheMapOfARun) {
    for (const std::string run : {"a run: 50% \"b\"", "bare"}) {
        fs::create_directory(folder_ / run);
        fs::copy(in("est.txt"), in(run + "/trajectory_kitti.txt"));
    }
    test::writeText(folder_ / "a run: 50% \"b\"/map.html", "<html></html>");
    const auto pageOf = [&](const std::string& report) {
        const auto result = eval({"--ref", in("ref.txt"), "--est", "<a>=" + in("a run: 50% \"b\""),
                                  "--est", in("bare"), "-o", in(report)});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return test::readText(in(report + "/report.html"));
    };
    const auto page = pageOf("deep/report");
    EXPECT_NE(page.find("<a href=\"../../a%20run%3A%2050%25%20%22b%22/map.html\">Map of "
                        "&lt;a&gt;</a>"),
              std::string::npos);
    EXPECT_EQ(page.find("Map of bare"), std::string::npos);
    for (const char* link : {"src=\"http", "href=\"http", "url(", "<script", "<link"})
        EXPECT_EQ(page.find(link), std::string::npos) << link;
    // Into the run's own folder: the link stays right wherever that is moved.
    EXPECT_NE(pageOf("a run: 50% \"b\"/report").find("<a href=\"../map.html\">"),
              std::string::npos);
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
}  // namespace
