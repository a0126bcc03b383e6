#include "delio/core/stage_options.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>

#include <cmath>
#include <functional>
#include <limits>
#include <sstream>

#include "delio/core/error.h"

namespace {
using delio::OptionField;
using mrpt::config::CConfigFileMemory;

struct SampleOptions : delio::StageOptions {
    double width = 0.25;
    unsigned count = 3;
    bool flag = false;

 protected:
    std::vector<OptionField> fields() const override {
        return {{"width", &SampleOptions::width, "m; how wide", -10, 10},
                {"count", &SampleOptions::count, "how many", 1, 4294967295.0},
                {"flag", &SampleOptions::flag, "whether at all"}};
    }
};

SampleOptions loaded(const std::string& lines) {
    SampleOptions options;
    options.loadFromConfigFile(CConfigFileMemory("[sample]\n" + lines), "sample");
    return options;
}

/** What is thrown, or "" if nothing is. */
std::string errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const delio::Error& e) {
        return e.what();
    }
    return "";
}

std::string faultOf(const std::string& lines) {
    return errorOf([&] { loaded(lines); });
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
}

TEST(StageOptions, KeysThatAreThereAreTakenAndOthersKeepTheirValue) {
    const auto options = loaded("count = 17\nflag = true\n");
    EXPECT_EQ(options.width, 0.25);
    EXPECT_EQ(options.count, 17U);
    EXPECT_TRUE(options.flag);
    EXPECT_EQ(loaded("width=-1e-3").width, -1e-3);
    EXPECT_EQ(loaded("").count, 3U);
}

TEST(StageOptions, CommentsAndSpacesAreNoPartOfAValue) {
    const auto options =
        loaded("# width = 9\n; count = 9\n  width   =  2.5  \ncount = 4 // four\n");
    EXPECT_EQ(options.width, 2.5);
    EXPECT_EQ(options.count, 4U);
}

TEST(StageOptions, TheEndsOfARangeBelongToIt) {
    EXPECT_EQ(loaded("width = -10").width, -10);
    EXPECT_EQ(loaded("width = 10").width, 10);
    EXPECT_EQ(loaded("count = 4294967295").count, 4294967295U);
    EXPECT_EQ(loaded("count = 1").count, 1U);
}

TEST(StageOptions, MalformedNumbersAreRefusedByName) {
    for (const char* text : {"abc", "1.5x", "", "nan", "inf", "-inf", "1e999", "10.0000001", "-11",
                             "0x1", "1,5", "1 2", "1.2.3", "e5", "true", "--1"}) {
        const auto fault = faultOf("width = " + std::string(text));
        EXPECT_TRUE(contains(fault, "sample.width")) << text << ": " << fault;
        EXPECT_TRUE(contains(fault, "'" + std::string(text) + "'")) << text << ": " << fault;
        EXPECT_TRUE(contains(fault, "from -10 to 10")) << text << ": " << fault;
        EXPECT_EQ(fault.find('\n'), fault.npos);
    }
    for (const char* text : {"abc", "", "1.5", "3.0", "0", "-1", "4294967296", "1e1", "7x", "nan"})
        EXPECT_TRUE(contains(faultOf("count = " + std::string(text)), "sample.count")) << text;
}

TEST(StageOptions, ABooleanIsTrueOrFalseAndNothingElse) {
    EXPECT_FALSE(loaded("flag = false").flag);
    for (const char* text : {"1", "0", "yes", "TRUE", "True", "", "truex"})
        EXPECT_TRUE(contains(faultOf("flag = " + std::string(text)), "sample.flag")) << text;
}

TEST(StageOptions, AnUnknownKeyIsRefusedByName) {
    EXPECT_TRUE(contains(faultOf("widht = 1"), "sample.widht"));
    EXPECT_TRUE(contains(faultOf("width = 1\nWidth2 = 1"), "sample.Width2"));
}

class RoundTrip : public testing::TestWithParam<double> {};

TEST_P(RoundTrip, WrittenTextGivesTheSameValues) {
    SampleOptions options;
    options.width = GetParam();
    options.count = 4294967295U;
    options.flag = true;
    std::ostringstream text;
    options.write(text, "sample");
    SampleOptions again;
    again.loadFromConfigFile(CConfigFileMemory(text.str()), "sample");
    EXPECT_EQ(again.width, options.width) << text.str();
    EXPECT_EQ(again.count, options.count);
    EXPECT_TRUE(again.flag);
    std::ostringstream textAgain;
    again.write(textAgain, "sample");
    EXPECT_EQ(textAgain.str(), text.str());
}

TEST_P(RoundTrip, MrptsConfigFilesGiveTheSameValues) {
    SampleOptions options;
    options.width = GetParam();
    options.count = 1;
    options.flag = true;
    CConfigFileMemory file;
    options.saveToConfigFile(file, "sample");
    for (const auto& source : {file, CConfigFileMemory(file.getContent())}) {
        SampleOptions again;
        again.loadFromConfigFile(source, "sample");
        EXPECT_EQ(again.width, options.width) << file.getContent();
        EXPECT_EQ(again.count, 1U);
        EXPECT_TRUE(again.flag);
    }
}

INSTANTIATE_TEST_SUITE_P(StageOptions, RoundTrip,
                         testing::Values(0.1, 1e-17, 0.0, 1.0 / 3, -M_PI, 9.999999999999998,
                                         0.30000000000000004, 123456789e-8,
                                         std::numeric_limits<double>::denorm_min(),
                                         -std::numeric_limits<double>::min(), 10.0));

TEST(StageOptions, EachKeyIsWrittenUnderItsMeaning) {
    std::ostringstream text;
    SampleOptions().write(text, "sample");
    EXPECT_EQ(text.str(),
              "[sample]\n# m; how wide\nwidth = 0.25\n# how many\ncount = 3\n"
              "# whether at all\nflag = false\n");
}

/** One that is one of a few words, and two that have to go together. */
struct RangeOptions : delio::StageOptions {
    std::string way = "up";
    double low = 1, high = 2;

    void check(const std::string& section) const override {
        delio::requireOrder(section + ".low", low, section + ".high", high);
    }

 protected:
    std::vector<OptionField> fields() const override {
        return {{"way", &RangeOptions::way, "which way", {"up", "down"}},
                {"low", &RangeOptions::low, "m; from"},
                {"high", &RangeOptions::high, "m; to"}};
    }
};

RangeOptions rangeOf(const std::string& lines) {
    RangeOptions options;
    options.loadFromConfigFile(CConfigFileMemory("[range]\n" + lines), "range");
    return options;
}

TEST(StageOptions, AWordIsOneOfThoseThatAreKnown) {
    EXPECT_EQ(rangeOf("").way, "up");
    EXPECT_EQ(rangeOf("way = down").way, "down");
    EXPECT_EQ(rangeOf("  way =   up  ").way, "up");
    for (const char* text : {"", "UP", "Down", "up down", "updown", "do", "1", "\"up\""})
        EXPECT_EQ(errorOf([&] { rangeOf("way = " + std::string(text)); }),
                  "option range.way: '" + std::string(text) + "' is not one of: up, down");
}

TEST(StageOptions, AWordIsWrittenAsItIsRead) {
    RangeOptions options;
    options.way = "down";
    std::ostringstream text;
    options.write(text, "range");
    EXPECT_EQ(text.str(),
              "[range]\n# which way\nway = down\n# m; from\nlow = 1\n# m; to\nhigh = 2\n");
    RangeOptions again, fromMrpt;
    again.loadFromConfigFile(CConfigFileMemory(text.str()), "range");
    EXPECT_EQ(again.way, "down");
    CConfigFileMemory file;
    options.saveToConfigFile(file, "range");
    fromMrpt.loadFromConfigFile(CConfigFileMemory(file.getContent()), "range");
    EXPECT_EQ(fromMrpt.way, "down");
}

TEST(StageOptions, WhatDoesNotGoTogetherIsFoundWhenAsked) {
    EXPECT_EQ(errorOf([] { SampleOptions().check("sample"); }), "");  // by default all goes
    EXPECT_EQ(errorOf([] { RangeOptions().check("range"); }), "");
    // Loading asks nothing: the other one may still come.
    RangeOptions options = rangeOf("low = 3.5");
    EXPECT_EQ(errorOf([&] { options.check("range"); }),
              "option range.low (3.5) must be at most range.high (2)");
    options.loadFromConfigFile(CConfigFileMemory("[range]\nhigh = 3.5\n"), "range");
    EXPECT_EQ(errorOf([&] { options.check("range"); }), "");
}

TEST(RequireOrder, EqualNumbersAreInOrderAndNaNIsNot) {
    const auto fault = [](double low, double high) {
        return errorOf([&] { delio::requireOrder("a.low", low, "b.high", high); });
    };
    EXPECT_EQ(fault(-1, 1), "");
    EXPECT_EQ(fault(0.1, 0.1), "");
    EXPECT_EQ(fault(0.1, -0.1), "option a.low (0.1) must be at most b.high (-0.1)");
    EXPECT_NE(fault(std::nextafter(1.0, 2.0), 1), "");
    EXPECT_NE(fault(NAN, 1), "");
    EXPECT_NE(fault(1, NAN), "");
}
}  // namespace
