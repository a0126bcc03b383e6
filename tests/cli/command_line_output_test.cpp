#include "command_line_output.h"

#include <gtest/gtest.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <iostream>
#include <sstream>

#include "cli.h"

namespace {
using namespace delio;

cli::HelpText someText() {
    cli::HelpText text;
    text.about = "More of it.";
    text.sections = {{"scan", "its points"}};
    text.writes = {{"a_file_with_a_long_name.txt", "rows"}};
    text.examples = {{{"tool -i a", "One"}, {"tool -i b", "Two"}}};
    text.interrupted = "nothing is left";
    return text;
}

std::string helpOf(TCLAP::CmdLine& cmd) {
    cli::CommandLineOutput output(cmd, someText());
    std::ostringstream out;
    auto* const shown = std::cout.rdbuf(out.rdbuf());
    output.usage(cmd);
    std::cout.rdbuf(shown);
    return out.str();
}

// Every kind of argument there is, in the order in which they are added, the required ones first.
TEST(CommandLineOutput, HelpIsOfGnusForm) {
    TCLAP::CmdLine cmd("one line", ' ', "1");
    TCLAP::ValueArg<cli::Count> count("", "count", "Count", false, {3}, "N", cmd);
    TCLAP::ValueArg<double> share("s", "share", "Share", false, 0.25, "S, 0 to 1", cmd);
    TCLAP::ValueArg<int> delta("", "delta", "Delta; default: none", false, 7, "N", cmd);
    TCLAP::SwitchArg force("", "force", "Force", cmd);
    TCLAP::MultiArg<std::string> input("i", "input", "Input", true, "IN", cmd);
    TCLAP::ValueArg<std::string> kind("", "kind", "A kind that takes more than one line to tell",
                                      true, "", "good|bad", cmd);
    const std::string help = helpOf(cmd), tool = program_invocation_short_name;
    EXPECT_EQ(help, tool + ": one line\n\nUsage: " + tool + R"( -i IN... --kind=KIND [OPTION]...

More of it.

Options:
  -i, --input=IN          (required) Input; may be repeated
      --kind=good|bad     (required) A kind that takes more than one line to
                          tell
      --count=N           Count; default: 3
  -s, --share=S           Share; 0 to 1; default: 0.25
      --delta=N           Delta; default: none
      --force             Force
  -h, --help              Displays usage information and exits.
      --version           Displays version information and exits.

Sections of --set:
  scan                    its points

Writes:
  a_file_with_a_long_name.txt
                          rows

Examples:
  One:
      $ tool -i a
  Two:
      $ tool -i b

Exit status:
  0    success
  1    the run failed; stderr says why, in one line
  2    wrong command line
  130  interrupted: nothing is left
)");
}
}  // namespace
