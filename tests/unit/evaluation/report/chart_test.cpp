#include "delio/evaluation/report/chart.h"

#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include "delio/core/error.h"
#include "test_data.h"

namespace {
using namespace delio;
using evaluation::Chart;

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
        EXPECT_NE(std::string(e.what()).find("gnuplot could not draw"), std::string::npos)
            << e.what();
    }
}
}  // namespace
