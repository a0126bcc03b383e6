// --help of every tool: what a user reads first, and what the manual page is made of.
#include "help_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "delio/run/run_folder.h"
#include "tools.h"

namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;

std::vector<std::string> wordsOf(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

std::vector<std::string> examplesOf(const std::string& tool) {
    std::vector<std::string> examples;
    for (const auto& line : test::helpLinesOf(tool))
        if (line.rfind("      $ ", 0) == 0) examples.push_back(line.substr(8));
    return examples;
}

/** Of an option's line. */
test::HelpOption optionOf(const std::string& tool, const std::string& name) {
    for (const auto& option : test::helpOptionsOf(tool))
        if (option.name == name) return option;
    ADD_FAILURE() << tool << " has no " << name;
    return {};
}

class HelpOfTool : public testing::TestWithParam<std::string> {
 protected:
    const std::string tool_ = GetParam();
};

TEST_P(HelpOfTool, HasEveryPartInEightyColumns) {
    const auto help = runTool(tool_, {"--help"});
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_EQ(help.err, "");
    const auto lines = test::helpLinesOf(tool_);
    ASSERT_GT(lines.size(), 10U);
    EXPECT_EQ(lines[0].rfind(tool_ + ": ", 0), 0U) << lines[0];
    EXPECT_EQ(lines[1], "");
    EXPECT_EQ(lines[2].rfind("Usage: " + tool_ + " -", 0), 0U) << lines[2];
    for (const auto& line : lines) {
        EXPECT_LE(line.size(), 80U) << line;
        EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
    }
    for (const std::string part : {"Options:", "Writes:", "Examples:", "Exit status:"})
        EXPECT_EQ(std::count(lines.begin(), lines.end(), part), 1) << part;
    EXPECT_FALSE(test::helpNamesOf(tool_, "Writes:").empty());
    EXPECT_EQ(test::helpNamesOf(tool_, "Exit status:"),
              (std::vector<std::string>{"0", "1", "2", "130"}));
}

TEST_P(HelpOfTool, NamesWhatIsRequiredFirst) {
    const auto options = test::helpOptionsOf(tool_);
    ASSERT_FALSE(options.empty());
    EXPECT_TRUE(std::is_partitioned(options.begin(), options.end(),
                                    [](const auto& option) { return option.isRequired(); }));
    const std::string usage = test::helpLinesOf(tool_)[2];
    for (const auto& option : options) {
        const auto used = usage.find(" " + (option.flag.empty() ? option.name : option.flag));
        EXPECT_EQ(used != usage.npos, option.isRequired()) << option.name << "\n" << usage;
        EXPECT_FALSE(option.text.empty()) << option.name;
    }
    // What is required is what the tool asks for.
    const auto nothing = runTool(tool_, {});
    EXPECT_EQ(nothing.exitCode, 2);
    for (const auto& option : options) {
        const std::regex asked("[( ]" + option.name + "[,)]");
        EXPECT_EQ(std::regex_search(nothing.err, asked), option.isRequired()) << option.name << "\n"
                                                                              << nothing.err;
    }
}

// Where nothing that they read is there and nothing can be written: they fail, but are understood.
TEST_P(HelpOfTool, HasTwoExamplesThatAreUnderstood) {
    const auto examples = examplesOf(tool_);
    EXPECT_EQ(examples.size(), 2U);
    const test::TemporaryFolder folder;
    const auto here = fs::current_path();
    fs::current_path(folder.path());
    for (const auto& example : examples) {
        auto words = wordsOf(example);
        EXPECT_EQ(words[0], tool_);
        words.erase(words.begin());
        const auto result = test::runToolOnFullDisk(tool_, words, 0);
        EXPECT_EQ(result.exitCode, 1) << example << "\n" << result.err;
    }
    fs::current_path(here);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_P(HelpOfTool, TakesValuesAfterEquals) {
    const auto required = test::helpOptionsOf(tool_);
    std::vector<std::string> apart, joined;
    for (const auto& option : required) {
        if (!option.isRequired() && option.name != "--input") continue;
        const std::string value = option.name == "--scans" ? "1" : "no/such=thing.rawlog";
        apart.insert(apart.end(), {option.name, value});
        joined.push_back(option.name + "=" + value);
    }
    const auto first = runTool(tool_, apart), second = runTool(tool_, joined);
    EXPECT_EQ(second.exitCode, first.exitCode);
    EXPECT_EQ(second.err, first.err);
    EXPECT_NE(first.err.find("no/such"), std::string::npos) << first.err;
    test::expectFailure(runTool(tool_, {"--force=1"}), 2, {"--force=1"});
}

INSTANTIATE_TEST_SUITE_P(EveryTool, HelpOfTool, testing::ValuesIn(test::kTools),
                         [](const auto& tool) {
                             std::string name = tool.param;
                             name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                             return name;
                         });

TEST(Help, TellsDefaults) {
    EXPECT_EQ(optionOf("delio-slam", "--profile").value,
              "accurate|paper|paper-extended|paper-literal");
    EXPECT_NE(optionOf("delio-slam", "--profile").text.find("; default: accurate"),
              std::string::npos);
    EXPECT_NE(optionOf("delio-figures", "--profile").text.find("; default: paper"),
              std::string::npos);
    EXPECT_NE(optionOf("synth2rawlog", "--noise").text.find("; default: 0.01"), std::string::npos);
    EXPECT_NE(optionOf("delio-eval", "--delta").text.find("; default: 1"), std::string::npos);
    // A range is no part of a value's name, and what has no default tells none.
    const auto elevation = optionOf("delio-snapshot", "--elevation");
    EXPECT_EQ(elevation.value, "DEG");
    EXPECT_NE(elevation.text.find("; -90 to 90"), std::string::npos) << elevation.text;
    EXPECT_EQ(optionOf("delio-map", "--crop").text.find("default"), std::string::npos);
    for (const auto& tool : test::kTools)
        for (const auto& option : test::helpOptionsOf(tool)) {
            const auto first = option.text.find("default");
            EXPECT_TRUE(first == std::string::npos ||
                        option.text.find("default", first + 1) == std::string::npos)
                << tool << " " << option.name << ": " << option.text;
        }
}

TEST(Help, TellsDefaultsWhateverIsAskedFor) {
    const auto plain = runTool("delio-slam", {"--help"});
    EXPECT_EQ(runTool("delio-slam", {"--threads", "4", "--profile", "paper", "-h"}).out, plain.out);
}

TEST(Help, NamesSectionsOfEachProfile) {
    std::set<std::string> sections;
    for (const std::string profile : {"accurate", "paper", "paper-literal"}) {
        std::istringstream config(
            runTool("delio-slam", {"--print-config", "--profile", profile}).out);
        for (std::string line; std::getline(config, line);)
            if (line[0] == '[') sections.insert(line.substr(1, line.size() - 2));
    }
    const auto named = test::helpNamesOf("delio-slam", "Sections of --set:");
    EXPECT_EQ(named.size(), sections.size());
    EXPECT_EQ(std::set<std::string>(named.begin(), named.end()), sections);
    for (const auto& section : test::helpNamesOf("delio-figures", "Sections of --set:"))
        EXPECT_EQ(sections.count(section), 1U) << section;
}

TEST(Help, NamesEveryFileOfARun) {
    const auto lines = test::helpLinesOf("delio-slam");
    std::string writes;
    for (auto line = std::find(lines.begin(), lines.end(), "Writes:"); line != lines.end(); ++line)
        writes += *line + " ";
    for (const auto& file : run::RunFolder(".").files()) {
        const std::string name = fs::path(file).filename();
        EXPECT_TRUE(std::regex_search(writes, std::regex(" " + name + "[, ]"))) << name;
    }
}
}  // namespace
