#pragma once
#include <string>
#include <vector>

#include "test_data.h"

namespace delio::test {
struct CommandResult {
    int exitCode = -1;  //!< 128 + signal if a signal ended it
    std::string out;
    std::string err;
};

/** Where one of the project's tools lies; any other name as it is. */
std::string toolPath(const std::string& tool);

/** Runs one of the project's tools (by its name) or any program of PATH, without a shell.
 *  `interruptAt`: as soon as stderr holds this text, Ctrl-C (SIGINT) is sent; empty: never. */
CommandResult runTool(const std::string& tool, const std::vector<std::string>& arguments,
                      const std::string& interruptAt = "");

/** A tool that runs beside the test. */
class RunningTool {
 public:
    RunningTool(const std::string& tool, const std::vector<std::string>& arguments);
    /** Kills it if it was not waited for. */
    ~RunningTool();
    RunningTool(const RunningTool&) = delete;
    RunningTool& operator=(const RunningTool&) = delete;

    int pid() const { return child_; }
    void send(int signal) const;
    bool hasEnded();
    /** What it has said on stderr so far. */
    std::string err() const;
    CommandResult wait();

 private:
    TemporaryFolder folder_;
    int child_ = -1, status_ = 0;
    bool ended_ = false;
};

/** The same on a disk that is full as soon as a file has `bytes` (a multiple of 1024): writing
 * fails from there on. stdout goes to stderr. */
CommandResult runToolOnFullDisk(const std::string& tool, const std::vector<std::string>& arguments,
                                std::size_t bytes);

/** True if `err` is one plain line: what the contract asks of every error. */
bool isOneLine(const std::string& err);

/** What stderr holds besides lines of progress, of warnings and of what is read. */
std::string errorOf(const CommandResult& result);

/** A failed run as the contract has it: its exit code, and one line (besides progress and warnings)
 *  that holds all `words`. */
void expectFailure(const CommandResult& result, int exitCode,
                   const std::vector<std::string>& words);
}  // namespace delio::test
