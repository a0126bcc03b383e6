#pragma once
#include <string>
#include <vector>

namespace delio::test {
struct CommandResult {
    int exitCode = -1;  //!< 128 + signal if a signal ended it
    std::string out;
    std::string err;
};

/** Where one of the project's tools lies; any other name as it is. */
std::string toolPath(const std::string& tool);

/** Runs one of the project's tools (by its name) or any program of PATH, without a shell. */
CommandResult runTool(const std::string& tool, const std::vector<std::string>& arguments);

/** True if `err` is one plain line: what the contract asks of every error. */
bool isOneLine(const std::string& err);
}  // namespace delio::test
