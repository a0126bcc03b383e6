// What users read of exceptions and of names that come from files.
#include <gtest/gtest.h>
#include <mrpt/core/exceptions.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <new>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/text.h"

namespace {
using namespace delio;

template <typename Action>
std::string messageOf(Action action) {
    try {
        action();
    } catch (const std::exception& e) {
        return plainMessage(e);
    }
    return "";
}

TEST(PlainMessage, IsInWordsThatAUserKnows) {
    EXPECT_EQ(plainMessage(Error("'a' is cut off")), "'a' is cut off");
    EXPECT_EQ(messageOf([] { ASSERTMSG_(1 > 2, "too few"); }), "too few");
    EXPECT_EQ(messageOf([] { ASSERT_(1 > 2); }), "the file is damaged or of an unknown kind");
    EXPECT_EQ(messageOf([] { ASSERT_GT_(1, 2); }), "the file is damaged or of an unknown kind");
    const auto throughMrpt = [](auto exception) {
        return messageOf([&] {
            MRPT_START
            throw exception;
            MRPT_END
        });
    };
    EXPECT_EQ(throughMrpt(std::runtime_error("the disk is full")), "the disk is full");
    EXPECT_EQ(throughMrpt(std::bad_alloc()), "out of memory");
    EXPECT_EQ(messageOf([] { throw std::bad_alloc(); }), "out of memory");
    EXPECT_EQ(messageOf([] { std::vector<int>().reserve(std::size_t(-1)); }), "out of memory");
    EXPECT_EQ(messageOf([] { (void)std::filesystem::file_size("/none/at/all"); }),
              "'/none/at/all': No such file or directory");
    EXPECT_EQ(messageOf([] { YAML::Load("a: [1"); }).find("line 1, column"), 0U)
        << messageOf([] { YAML::Load("a: [1"); });
    const auto node = YAML::Load("a: x");
    EXPECT_EQ(messageOf([&] { (void)node["a"].as<double>(); }),
              "line 1, column 4: a value has the wrong type");
    EXPECT_EQ(messageOf([&] { (void)node["b"].as<double>(); }), "'b' is missing");
}

TEST(Shortened, KeepsBeginAndEndAndWholeCharacters) {
    EXPECT_EQ(shortened("as it is", 8), "as it is");
    EXPECT_EQ(shortened("0123456789abcdef", 9), "012345...def");
    const std::string ues = shortened("\xC3\xBC\xC3\xBC\xC3\xBC\xC3\xBC\xC3\xBC\xC3\xBC", 9);
    EXPECT_EQ(ues, "\xC3\xBC\xC3\xBC\xC3\xBC...\xC3\xBC");
    EXPECT_EQ(shortened(std::string(100000, 'x'), 2000).size(), 2003U);
}

TEST(Printable, HasNothingThatATerminalObeys) {
    EXPECT_EQ(printable("\x1B]0;x\x07\n\x7F"), "?]0;x???");
    EXPECT_EQ(printable("\xC2\x9B"
                        "2J"),
              "?2J");
    EXPECT_EQ(printable("\x9B"
                        "2J"),
              "?2J");
    EXPECT_EQ(printable("Stra\xC3\x9F"
                        "e"),
              "Stra\xC3\x9F"
              "e");
}
}  // namespace
