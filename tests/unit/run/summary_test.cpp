#include "delio/run/summary.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"
#include "delio/version.h"
#include "test_data.h"

namespace {
using namespace delio;
using run::Summary;

/** No field as it is by default, and numbers and texts that a writer might spoil. */
Summary anySummary() {
    Summary s;
    s.version = "1.2.3";
    s.command = R"(delio-slam -i "a b.rawlog" -o 'out' --set x.y=1: # [no] {map} \ ü)";
    s.profile = "paper";
    s.complete = true;
    s.fault = "scan 7: 'a.bin'\nis cut off\t- or so";
    s.scans = 100000;  // as a double its shortest form is 1e+05
    s.predicted = 3000000;
    s.longest_predicted = 1000000;
    s.weakly_observed = 400000;
    s.longest_weakly_observed = 12;
    s.weakly_observed_along = {380000, 0, 2};
    s.weakly_observed_about = {0, 7, 100000};
    s.interrupted = 3;
    s.standing = 2;
    s.searched = 11;
    s.longest_searched = 5;
    s.deskewed = 200000;
    s.path_m = 0.1 + 0.2;
    s.vertical_correction_deg = -0.205;
    s.ms_per_scan = 1.0 / 3;
    s.ms_per_scan_of_stages = {{"read", 1e-7}, {"registration", 1e22}, {"graph", 0}};
    s.latency_ms = {{"median", 9.5}, {"p95", 12}, {"worst", 1.0 / 7}};
    s.map_ms_per_scan = 4.25;
    s.optimisation_ms = 5e3;
    s.optimisation_iterations = 1000000;
    s.optimisation_cost_before = 1.7610316521916969e-25;
    s.optimisation_cost_after = 123456789.123456789;
    s.map_and_pictures_ms = 6;
    s.peak_rss_mb = 352.96875;
    s.warnings = {"first: one", "", "true", "12", "- \"second\""};
    s.metrics = {{"length_m", 3.0}, {"segments", 100000}, {"ape_m", 1e-9}};
    s.metrics_before_optimisation = {{"length_m", 4.0}, {"end_error_percent", 0.1}};
    return s;
}

void expectSame(const Summary& a, const Summary& b) {
    EXPECT_EQ(a.version, b.version);
    EXPECT_EQ(a.command, b.command);
    EXPECT_EQ(a.profile, b.profile);
    EXPECT_EQ(a.complete, b.complete);
    EXPECT_EQ(a.fault, b.fault);
    EXPECT_EQ(a.scans, b.scans);
    EXPECT_EQ(a.predicted, b.predicted);
    EXPECT_EQ(a.longest_predicted, b.longest_predicted);
    EXPECT_EQ(a.weakly_observed, b.weakly_observed);
    EXPECT_EQ(a.longest_weakly_observed, b.longest_weakly_observed);
    EXPECT_EQ(a.weakly_observed_along, b.weakly_observed_along);
    EXPECT_EQ(a.weakly_observed_about, b.weakly_observed_about);
    EXPECT_EQ(a.interrupted, b.interrupted);
    EXPECT_EQ(a.standing, b.standing);
    EXPECT_EQ(a.searched, b.searched);
    EXPECT_EQ(a.longest_searched, b.longest_searched);
    EXPECT_EQ(a.deskewed, b.deskewed);
    EXPECT_EQ(a.path_m, b.path_m);
    EXPECT_EQ(a.vertical_correction_deg, b.vertical_correction_deg);
    EXPECT_EQ(a.ms_per_scan, b.ms_per_scan);
    EXPECT_EQ(a.ms_per_scan_of_stages, b.ms_per_scan_of_stages);
    EXPECT_EQ(a.latency_ms, b.latency_ms);
    EXPECT_EQ(a.map_ms_per_scan, b.map_ms_per_scan);
    EXPECT_EQ(a.optimisation_ms, b.optimisation_ms);
    EXPECT_EQ(a.optimisation_iterations, b.optimisation_iterations);
    EXPECT_EQ(a.optimisation_cost_before, b.optimisation_cost_before);
    EXPECT_EQ(a.optimisation_cost_after, b.optimisation_cost_after);
    EXPECT_EQ(a.map_and_pictures_ms, b.map_and_pictures_ms);
    EXPECT_EQ(a.peak_rss_mb, b.peak_rss_mb);
    EXPECT_EQ(a.warnings, b.warnings);
    EXPECT_EQ(a.metrics, b.metrics);
    EXPECT_EQ(a.metrics_before_optimisation, b.metrics_before_optimisation);
}

TEST(Summary, EveryFieldComesBack) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "summary.yaml";
    run::writeSummary(anySummary(), file);
    expectSame(run::readSummary(file), anySummary());
    // One that has as little as possible.
    run::writeSummary(Summary(), file);
    expectSame(run::readSummary(file), Summary());
}

TEST(Summary, WhatIsNoSummaryIsAnError) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "summary.yaml";
    const auto expectError = [&] {
        try {
            run::readSummary(file);
            ADD_FAILURE() << "no error";
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        }
    };
    expectError();  // missing
    run::writeSummary(anySummary(), file);
    const std::string text = test::readText(file);
    const auto withScans = [&](const std::string& number) {
        const std::string line = "\nscans: 100000\n";
        const auto at = text.find(line);
        EXPECT_NE(at, std::string::npos) << text;
        return std::string(text).replace(at, line.size(), "\nscans: " + number + "\n");
    };
    for (const std::string& wrong :
         {std::string(), std::string("words\n"), std::string("- 1\n"), std::string("a: [1\n"),
          text.substr(0, text.size() / 2), withScans("many"), withScans("1.5"), withScans("-1")}) {
        test::writeText(file, wrong);
        expectError();
    }
}

TEST(Summary, SumsUpARecord) {
    run::RunRecord record;
    record.profile = "accurate";
    record.command = {"delio-slam", "-i", "d.rawlog"};
    record.complete = true;
    record.fault = "none";
    record.warnings = {"one"};
    record.optimise_ms = 7;
    record.optimisation = {4, 2, 3, true};
    for (int i = 0; i < 4; ++i) {
        run::RunRow row;
        row.read_ms = 1;
        row.predicted = i == 1;
        row.searched = i > 1;
        row.deskewed = i > 0;
        ScanReport report;
        report.step.times_ms = {{"registration", 10.0 * i}};
        report.listeners_ms = {{"graph", 2}, {"map", 5}};
        row.figures = run::RowFigures(report, {});
        record.rows.push_back(row);
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.translation().x() = 2 * i;
        record.final.poses.push_back(pose);
    }
    const auto summary = run::summaryOf(record, 9);
    EXPECT_EQ(summary.version, kVersion);
    EXPECT_EQ(summary.command, "delio-slam -i d.rawlog");
    EXPECT_EQ(summary.profile, "accurate");
    EXPECT_TRUE(summary.complete);
    EXPECT_EQ(summary.fault, "none");
    EXPECT_EQ(summary.scans, 4U);
    EXPECT_EQ(summary.predicted, 1U);
    EXPECT_EQ(summary.searched, 2U);
    EXPECT_EQ(summary.longest_searched, 2U);
    EXPECT_EQ(summary.deskewed, 3U);
    EXPECT_EQ(summary.path_m, 6);
    EXPECT_EQ(summary.ms_per_scan, 1 + 15 + 2);  // the map is told apart
    EXPECT_EQ(summary.ms_per_scan_of_stages,
              (Summary::Figures{{"read", 1}, {"registration", 15}, {"graph", 2}}));
    EXPECT_EQ(summary.latency_ms, (Summary::Figures{{"median", 13}, {"p95", 33}, {"worst", 33}}));
    EXPECT_EQ(summary.map_ms_per_scan, 5);
    EXPECT_EQ(summary.optimisation_ms, 7);
    EXPECT_EQ(summary.optimisation_iterations, 3U);
    EXPECT_EQ(summary.optimisation_cost_before, 4);
    EXPECT_EQ(summary.optimisation_cost_after, 2);
    EXPECT_EQ(summary.map_and_pictures_ms, 9);
    EXPECT_GT(summary.peak_rss_mb, 1);
    EXPECT_EQ(summary.warnings, record.warnings);
    EXPECT_TRUE(summary.metrics.empty());
}
}  // namespace
