#include "delio/core/text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <locale>
#include <sstream>

namespace {
using delio::digitsOf;
using delio::fixed;
using delio::numberIn;
using delio::numbersIn;
using delio::rounded;

constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

TEST(Numbers, ANumberIsRead) {
    EXPECT_EQ(numberIn<double>("1.5"), 1.5);
    EXPECT_EQ(numberIn<double>("-2e-3"), -2e-3);
    EXPECT_EQ(numberIn<double>("7"), 7);
    EXPECT_EQ(numberIn<double>(".5"), 0.5);
    EXPECT_EQ(numberIn<double>("5."), 5);
    EXPECT_EQ(numberIn<int>("-12"), -12);
    EXPECT_EQ(numberIn<unsigned>("0012"), 12U);
    EXPECT_TRUE(std::signbit(numberIn<double>("-0").value()));
    EXPECT_TRUE(std::isnan(numberIn<double>("nan").value()));
    EXPECT_EQ(numberIn<double>("-inf"), -std::numeric_limits<double>::infinity());
}

TEST(Numbers, WhatIsNoNumberOrMoreThanOneIsNone) {
    for (const char* text :
         {"",    " ",   "x",   "-",  ".",     "e5",  "+1", "+",   "--1", "+-1", " 1", "1 ",
          "\t1", "1\n", "1\r", "1x", "1.5.2", "1,5", "1e", "1e+", "0x1", "1 2", "1;", "true"}) {
        EXPECT_FALSE(numberIn<double>(text)) << "'" << text << "'";
        EXPECT_FALSE(numberIn<int>(text)) << "'" << text << "'";
        EXPECT_FALSE(numberIn<std::uint64_t>(text)) << "'" << text << "'";
    }
    EXPECT_FALSE(numberIn<double>(std::string_view()));
    EXPECT_FALSE(numberIn<double>(std::string_view("1\0", 2)));
    for (const char* text : {"1.0", "1e3", "nan", "inf"}) EXPECT_FALSE(numberIn<int>(text)) << text;
}

TEST(Numbers, WhatTheTypeDoesNotHoldIsNone) {
    EXPECT_EQ(numberIn<std::uint8_t>("255"), std::uint8_t{255});
    EXPECT_FALSE(numberIn<std::uint8_t>("256"));
    EXPECT_FALSE(numberIn<unsigned>("-1"));
    EXPECT_EQ(numberIn<std::int64_t>("-9223372036854775808"),
              std::numeric_limits<std::int64_t>::min());
    EXPECT_FALSE(numberIn<std::int64_t>("9223372036854775808"));
    EXPECT_EQ(numberIn<double>("1.7976931348623157e308"), kMax);
    EXPECT_FALSE(numberIn<double>("1e309"));
    EXPECT_FALSE(numberIn<double>("-1e309"));
    EXPECT_FALSE(numberIn<double>("1e-999"));
    EXPECT_EQ(numberIn<double>("5e-324"), kLeast);
}

TEST(Numbers, OnlyTheTextItselfIsRead) {
    const std::string_view line = "12345 6";
    EXPECT_EQ(numberIn<int>(line.substr(0, 2)), 12);
    EXPECT_EQ(numberIn<double>(line.substr(3, 2)), 45);
}

TEST(Numbers, DigitsGiveTheSameNumberBack) {
    for (const double number : {0.0, 0.1, 1.0 / 3, -M_PI, 1e-17, 1e300, kMax, kLeast, -kMax,
                                2.5e-308, 0.30000000000000004, 1317354879.123456})
        EXPECT_EQ(numberIn<double>(digitsOf(number)), number) << digitsOf(number);
    EXPECT_EQ(numberIn<float>(digitsOf(0.1F)), 0.1F);
    EXPECT_EQ(digitsOf(-0.0), "-0");
    EXPECT_EQ(numberIn<std::uint64_t>(digitsOf(~std::uint64_t{0})), ~std::uint64_t{0});
    EXPECT_EQ(numberIn<int>(digitsOf(-2147483647 - 1)), -2147483647 - 1);
    EXPECT_TRUE(std::isnan(numberIn<double>(digitsOf(std::nan(""))).value()));
    EXPECT_EQ(numberIn<double>(digitsOf(HUGE_VAL)), HUGE_VAL);
}

TEST(Numbers, DigitsAreTheFewest) {
    EXPECT_EQ(digitsOf(0.1), "0.1");
    EXPECT_EQ(digitsOf(0.1F), "0.1");
    EXPECT_EQ(digitsOf(100.0), "100");
    EXPECT_EQ(digitsOf(1e300), "1e+300");
    EXPECT_EQ(digitsOf(1234567U), "1234567");
    EXPECT_EQ(digitsOf(-3), "-3");
}

TEST(Numbers, AreWrittenWithSoManyDigits) {
    char text[400];
    for (const double number :
         {0.0, -0.0, 0.125, 2.5, -1234.56789, 1e-17, 1e22, kMax, kLeast, HUGE_VAL})
        for (const int digits : {1, 3, 7, 17}) {
            std::snprintf(text, sizeof(text), "%.*f", digits, number);
            EXPECT_EQ(fixed(number, digits), text);
            std::snprintf(text, sizeof(text), "%.*g", digits, number);
            EXPECT_EQ(rounded(number, digits), text);
        }
    EXPECT_EQ(fixed(std::nan(""), 2), "nan");
}

TEST(Numbers, NumbersOfALineAreReadUpToItsEndOrAWord) {
    using Numbers = std::vector<double>;
    EXPECT_EQ(numbersIn(" 1 -2.5\t3e2\r\n4 "), (Numbers{1, -2.5, 300, 4}));
    EXPECT_EQ(numbersIn("7 8 x 9"), (Numbers{7, 8}));
    EXPECT_EQ(numbersIn("7 nan 9"), Numbers{7});
    EXPECT_EQ(numbersIn("1,5 2"), Numbers());
    EXPECT_EQ(numbersIn("   "), Numbers());
    EXPECT_EQ(numbersIn(""), Numbers());
}

/** 1.234,5 in place of 1234.5: a locale that is there wherever the test runs. */
struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

class InALocaleWithCommas : public testing::Test {
 protected:
    // C's locale as well, where the machine has such a one.
    InALocaleWithCommas() { std::setlocale(LC_NUMERIC, "de_DE.UTF-8"); }
    ~InALocaleWithCommas() override {
        std::locale::global(before_);
        std::setlocale(LC_NUMERIC, "C");
    }

    std::locale before_ = std::locale::global(std::locale(std::locale(), new Commas));
};

TEST_F(InALocaleWithCommas, NumbersAreReadAndWrittenAsEver) {
    std::ostringstream stream;
    stream << 1234.5;
    ASSERT_EQ(stream.str(), "1.234,5");  // the locale is in effect
    EXPECT_EQ(numberIn<double>("1234.5"), 1234.5);
    EXPECT_FALSE(numberIn<double>("1234,5"));
    EXPECT_FALSE(numberIn<double>("1.234,5"));
    EXPECT_FALSE(numberIn<int>("1.234"));
    EXPECT_EQ(digitsOf(1234.5), "1234.5");
    EXPECT_EQ(digitsOf(1234567), "1234567");
    EXPECT_EQ(fixed(1234.5, 2), "1234.50");
    EXPECT_EQ(rounded(1234.5, 9), "1234.5");
    EXPECT_EQ(numbersIn("1234.5 2"), (std::vector<double>{1234.5, 2}));
}
}  // namespace
