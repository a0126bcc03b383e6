#include "evaluation/charts.h"

#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include "delio/core/error.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
using evaluation::Chart;
using namespace delio::evaluation;

Chart simple(const std::string& title) {
    Chart chart("simple", "A line");
    chart.label("x", "it's y");
    chart.curve(title, "with lines", {{0, 1}, {1, 2.5}, {2, 2}});
    return chart;
}

TEST(Chart, DrawsTheSamePictureTwice) {
    const test::TemporaryFolder folder, again;
    for (const auto* target : {&folder, &again})
        evaluation::drawCharts({simple("line")}, target->path());
    for (const char* file : {"simple.dat", "simple.gp", "simple.svg", "simple.png"})
        EXPECT_TRUE(test::readText(folder / file) == test::readText(again / file)) << file;
    EXPECT_EQ(test::readText(folder / "simple.dat"), "# line\n0 1\n1 2.5\n2 2\n");
    const auto svg = test::readText(folder / "simple.svg");
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    EXPECT_NE(svg.find("it's y"), std::string::npos);
    mrpt::img::CImage png;
    ASSERT_TRUE(png.loadFromFile((folder / "simple.png").string()));
    EXPECT_EQ(png.getWidth(), 1120U);
    EXPECT_FALSE(std::filesystem::exists(folder / "gnuplot.log"));
}

TEST(Chart, ATitleIsOnlyText) {
    const test::TemporaryFolder folder;
    const std::string mark = folder / "ran";
    // Quotes, and what gnuplot runs or expands outside of single quotes.
    const std::string title = "a'b\" `touch " + mark + "` @m %s \\n <b>&";
    Chart chart("simple", "");
    chart.curve(title.substr(0, 8), "with lines", {{0, 1}, {1, 2}});
    chart.curve("'; system('touch " + mark + "'); '", "with lines", {{0, 1}, {1, 2}});
    chart.curve(title, "with lines", {{0, 1}, {1, 2}});
    chart.curve("c_d^{e} \n\t\x01 \xff\xfe \xc3\xbc", "with lines", {{0, 2}, {1, 1}});
    evaluation::drawCharts({chart}, folder.path());
    EXPECT_FALSE(std::filesystem::exists(mark));
    const auto svg = test::readText(folder / "simple.svg");
    EXPECT_NE(svg.find("a'b"), std::string::npos);
    EXPECT_NE(svg.find("c_d^{e} ??? ?? \xc3\xbc"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("<b>"), std::string::npos);
}

TEST(Chart, CurvesKeepTheirDataApart) {
    Chart chart("two", "");
    EXPECT_TRUE(chart.empty());
    chart.curve("none", "with lines", {});
    EXPECT_TRUE(chart.empty());
    chart.curve("a", "with lines", {{1, 2}});
    chart.curve("b", "with lines", {{3, 4}});
    EXPECT_EQ(chart.data(), "# a\n1 2\n\n\n# b\n3 4\n");
    EXPECT_NE(chart.script().find("index 1 with lines title \"b\""), std::string::npos)
        << chart.script();
}

TEST(Chart, GnuplotsFailureIsAnError) {
    const test::TemporaryFolder folder;
    auto chart = simple("line");
    chart.set("set nonsense");
    try {
        evaluation::drawCharts({chart}, folder.path());
        FAIL() << "drawn all the same";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("gnuplot failed"), std::string::npos) << e.what();
    }
}

/** A pose every 0.1 s at a constant speed; the estimate is `percent` too long. */
Comparison drive(double speed_mps, double percent, std::size_t poses) {
    Comparison comparison;
    for (std::size_t i = 0; i < poses; ++i) {
        const double x = 0.1 * speed_mps * static_cast<double>(i);
        comparison.reference.push_back(delio::test::poseAt(x, 0, 0));
        comparison.estimate.push_back(delio::test::poseAt(x * (1 + percent / 100), 0, 0));
        comparison.times_s.push_back(0.1 * static_cast<double>(i));
    }
    comparison.row = score(comparison.reference, comparison.estimate, {50, 100}, 1);
    return comparison;
}

TEST(SegmentCurves, OverLengthAllSegmentsOfALengthCount) {
    const auto slow = drive(7, 1, 400), fast = drive(13, 3, 400);
    const auto curve = errorOverLength({&slow, &fast});
    ASSERT_EQ(curve.size(), 2U);
    EXPECT_DOUBLE_EQ(curve[0].at, 50);
    EXPECT_DOUBLE_EQ(curve[1].at, 100);
    const auto& a = slow.row.kitti.perLength[0];
    const auto& b = fast.row.kitti.perLength[0];
    const auto n = static_cast<double>(a.segments), m = static_cast<double>(b.segments);
    EXPECT_NEAR(curve[0].t_percent, (a.t_percent * n + b.t_percent * m) / (n + m), 1e-9);
    EXPECT_NEAR(curve[0].r_deg_per_100m, 0, 1e-9);
}

TEST(SegmentCurves, OverSpeedNeighboursShareSegments) {
    const auto slow = drive(7, 1, 400), fast = drive(13, 3, 400);
    // At nearly 7 m/s: the points 6 and 8; at nearly 13 m/s: 12 and 14.
    const auto curve = errorOverSpeed({&slow, &fast});
    ASSERT_EQ(curve.size(), 4U);
    const double kmh[] = {6 * 3.6, 8 * 3.6, 12 * 3.6, 14 * 3.6};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_DOUBLE_EQ(curve[i].at, kmh[i]);
        EXPECT_NEAR(curve[i].t_percent, i < 2 ? 1 : 3, 0.1);
    }
}

TEST(SegmentCurves, FewerThanThreeSegmentsMakeNoPoint) {
    const auto brief = drive(10, 1, 115);  // two segments of 100 m, seven of 50 m
    ASSERT_EQ(brief.row.kitti.perLength[1].segments, 2U);
    const auto curve = errorOverLength({&brief});
    ASSERT_EQ(curve.size(), 1U);
    EXPECT_DOUBLE_EQ(curve[0].at, 50);
    EXPECT_TRUE(errorOverLength({}).empty());
}

TEST(SegmentCurves, StampsThatCoincideHaveNoSpeed) {
    auto comparison = drive(10, 1, 400);
    for (auto& t : comparison.times_s) t = 5;
    EXPECT_TRUE(errorOverSpeed({&comparison}).empty());
}
}  // namespace
