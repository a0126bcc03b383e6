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
    std::vector<OptionField> fields() override {
        return {{"width", &width, "m; how wide", -10, 10},
                {"count", &count, "how many", 1, 4294967295.0},
                {"flag", &flag, "whether at all"}};
    }
};

SampleOptions loaded(const std::string& lines) {
    SampleOptions options;
    options.loadFromConfigFile(CConfigFileMemory("[sample]\n" + lines), "sample");
    return options;
}

/** What is thrown, or "" if nothing is. */
std::string faultOf(const std::string& lines) {
    try {
        loaded(lines);
    } catch (const delio::Error& e) {
        return e.what();
    }
    return "";
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
}  // namespace
