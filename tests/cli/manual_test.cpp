// share/scripts/manual: the manual page of every tool.
#include <gtest/gtest.h>

#include "help_lines.h"
#include "tools.h"

namespace {
using namespace delio;
using test::runTool;

/** Of a page, without what a terminal draws bold with. */
std::string read(const std::string& page) {
    const auto result = runTool(
        "bash",
        {"-o", "pipefail", "-c",
         "LC_ALL=C.UTF-8 MANWIDTH=80 MANPAGER=cat man --warnings=all -l '" + page + "' | col -bx"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out;
}

TEST(Manual, OfEachToolHasAllThatHelpHas) {
    if (runTool("sh", {"-c", "command -v help2man && command -v man"}).exitCode != 0) {
        if (test::dataIsRequired()) FAIL() << "help2man or man-db is not installed";
        GTEST_SKIP() << "help2man or man-db is not installed";
    }
    const test::TemporaryFolder folder;
    for (const auto& tool : test::kTools) {
        const std::string path = folder / (tool + ".1");
        const auto made = runTool(test::profileFolder().parent_path() / "scripts/manual",
                                  {test::toolPath(tool), path});
        ASSERT_EQ(made.exitCode, 0) << made.err;
        const std::string page = read(path);
        for (const std::string part : {"SYNOPSIS", "OPTIONS", "WRITES", "EXAMPLES", "EXIT STATUS"})
            EXPECT_NE(page.find("\n" + part + "\n"), std::string::npos) << tool << part;
        for (const auto& option : test::helpOptionsOf(tool)) {
            const std::string line = (option.flag.empty() ? "" : option.flag + ", ") + option.name +
                                     (option.value.empty() ? "" : "=" + option.value);
            EXPECT_NE(page.find("       " + line), std::string::npos) << tool << line;
        }
        // What whatis and apropos read.
        const std::string about = test::helpLinesOf(tool)[0].substr(tool.size() + 2);
        const auto whatis = runTool("lexgrog", {path});
        EXPECT_NE(whatis.out.find("\"" + tool + " - " + about + "\""), std::string::npos)
            << whatis.out;
    }
}
}  // namespace
