#include "delio/evaluation/report.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace {
using namespace delio::evaluation;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ReportRow row(const std::string& sequence, double length_m, std::size_t segments, double t) {
    ReportRow result;
    result.name = "x";
    result.sequence = sequence;
    result.length_m = length_m;
    result.kitti.segments = segments;
    result.kitti.t_percent = t;
    result.kitti.r_deg_per_100m = t / 4;
    result.ape_m = 1;
    result.rpe_m = 0.25;
    result.rpe_deg = 0.125;
    return result;
}

TEST(Report, TsvHasTheColumnsOfTheContract) {
    std::ostringstream out;
    writeMetricsTsv({row("00", 12.5, 3, 0.5), row("01", 2, 0, kNone)}, out);
    EXPECT_EQ(out.str(),
              "name\tsequence\tlength_m\tsegments\tt_percent\tr_deg_per_100m\tape_m\trpe_m\t"
              "rpe_deg\n"
              "x\t00\t12.500000000\t3\t0.500000000\t0.125000000\t1.000000000\t0.250000000\t"
              "0.125000000\n"
              "x\t01\t2.000000000\t0\t-\t-\t1.000000000\t0.250000000\t0.125000000\n");
}

TEST(Report, TheTableSaysItsUnits) {
    std::ostringstream out;
    writeTable({row("00", 12.5, 3, 0.5)}, out);
    for (const char* unit : {"length [m]", "translation [%]", "rotation [deg/100 m]"})
        EXPECT_NE(out.str().find(unit), std::string::npos) << out.str();
}
}  // namespace
