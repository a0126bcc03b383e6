// What every tool has.
#include <gtest/gtest.h>

#include <string>

#include "command.h"
#include "delio/version.h"
#include "tools.h"

namespace {
using namespace delio;
using test::runTool;

TEST(EveryTool, HelpAndVersion) {
    for (const auto& tool : test::kTools) {
        const auto help = runTool(tool, {"--help"});
        EXPECT_EQ(help.exitCode, 0) << tool;
        EXPECT_EQ(help.err, "") << tool;
        for (const std::string option : {"--help", "--version", "--verbose"})
            EXPECT_NE(help.out.find(option), std::string::npos) << tool << option;
        const auto version = runTool(tool, {"--version"});
        EXPECT_EQ(version.exitCode, 0) << tool;
        EXPECT_EQ(version.out, tool + " " + kVersion + "\n");
        EXPECT_EQ(version.err, "") << tool;
        const auto nothing = runTool(tool, {});
        test::expectFailure(nothing, 2, {"--help"});
        EXPECT_EQ(nothing.out, "") << tool;
    }
}

TEST(EveryTool, AnArgumentWithoutAnOptionIsNamed) {
    for (const auto& tool : test::kTools) {
        test::expectFailure(runTool(tool, {"drive", "results"}), 2,
                            {"unexpected argument 'drive'", "--help"});
        test::expectFailure(runTool(tool, {"--nonsense"}), 2, {"unknown option '--nonsense'"});
    }
    test::expectFailure(runTool("delio-slam", {"drive", "results"}), 2,
                        {"give inputs with -i and outputs with -o"});
}

TEST(EveryTool, TakesAnOptionThatIsGivenAgain) {
    for (const auto& tool : test::kTools) {
        const auto run = runTool(tool, {"--verbose", "--verbose"});
        EXPECT_EQ(run.exitCode, 2) << tool;  // what is required is missing
        EXPECT_EQ(run.err.find("already set"), std::string::npos) << run.err;
        EXPECT_NE(run.err.find("required arguments missing"), std::string::npos) << run.err;
    }
}
}  // namespace
