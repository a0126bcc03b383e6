#include "delio/run/run_record.h"

#include <gtest/gtest.h>

namespace {
using namespace delio;

ScanReport someReport() {
    ScanReport report;
    Step& step = report.step;
    step.predicted = step.searched = step.interrupted = step.standing = step.deskewed = true;
    step.reason = "not found in the map";
    step.increment.pose.translation() << 3, 0, 4;
    step.quality.matches = 8;
    step.notFinite = 10;
    step.times_ms = {{"a stage with a name that is long", 1.5}, {"planes", 2}};
    step.details = {{"scale", 1e-300}};
    report.listeners_ms = {{"graph", 3}, {"map", 100}};
    return report;
}

TEST(RunRow, HasWhatTheReportSays) {
    const auto report = someReport();
    Scan scan;
    scan.index = 7;
    scan.stamp_s = 0.1 + 0.2;
    scan.sensorPose.translation() << 1, 2, 3;
    const auto first = run::rowOf(scan, report, 5.5, nullptr);
    const auto second = run::rowOf(scan, report, 5.5, &first);
    auto other = report;
    other.step.details = {{"another", -0.0}, {"name", 2}};
    const auto third = run::rowOf(scan, other, 5.5, &second);
    for (const auto* row : {&first, &second, &third}) {
        EXPECT_EQ(row->scan, 7U);
        EXPECT_EQ(row->stamp_s, 0.1 + 0.2);
        EXPECT_EQ(row->sensorPose.matrix(), scan.sensorPose.matrix());
        EXPECT_TRUE(row->predicted && row->searched && row->interrupted && row->standing &&
                    row->deskewed);
        EXPECT_EQ(row->reason, report.step.reason);
        EXPECT_EQ(row->quality.matches, 8U);
        EXPECT_EQ(row->notFinite, 10U);
        EXPECT_EQ(row->moved_m, 5);
        EXPECT_EQ(row->figures.stages_ms(), report.step.times_ms);
        EXPECT_EQ(row->figures.listeners_ms(), report.listeners_ms);
        EXPECT_EQ(row->total_ms(), 5.5 + 1.5 + 2 + 3);  // the map is not counted
    }
    EXPECT_EQ(second.figures.details(), report.step.details);
    EXPECT_EQ(third.figures.details(), other.step.details);
    EXPECT_TRUE(run::RunRow().figures.stages_ms().empty());
}
}  // namespace
