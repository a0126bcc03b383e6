#include "command.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <sstream>

#include "test_data.h"

namespace delio::test {
std::string toolPath(const std::string& tool) {
    const std::filesystem::path own = std::filesystem::path(DELIO_TOOLS) / tool;
    return std::filesystem::exists(own) ? own.string() : tool;
}

RunningTool::RunningTool(const std::string& tool, const std::vector<std::string>& arguments) {
    const std::string program = toolPath(tool);
    std::vector<std::string> words = {program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    const std::string out = folder_ / "out", err = folder_ / "err";
    std::fflush(nullptr);
    child_ = fork();
    if (child_ == 0) {
        if (!freopen("/dev/null", "r", stdin) || !freopen(out.c_str(), "w", stdout) ||
            !freopen(err.c_str(), "w", stderr))
            _exit(126);
        execvp(argv[0], argv.data());
        _exit(127);
    }
}

RunningTool::~RunningTool() {
    if (ended_) return;
    kill(child_, SIGKILL);
    waitpid(child_, &status_, 0);
}

void RunningTool::send(int signal) const { kill(child_, signal); }

bool RunningTool::hasEnded() {
    if (!ended_) ended_ = waitpid(child_, &status_, WNOHANG) != 0;
    return ended_;
}

std::string RunningTool::err() const {
    const auto file = folder_ / "err";
    return std::filesystem::exists(file) ? readText(file) : "";
}

CommandResult RunningTool::wait() {
    if (!ended_) waitpid(child_, &status_, 0);
    ended_ = true;
    CommandResult result;
    result.exitCode = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    result.out = readText(folder_ / "out");
    result.err = err();
    return result;
}

CommandResult runTool(const std::string& tool, const std::vector<std::string>& arguments,
                      const std::string& interruptAt) {
    RunningTool running(tool, arguments);
    while (!interruptAt.empty() && !running.hasEnded()) {
        if (running.err().find(interruptAt) != std::string::npos) {
            running.send(SIGINT);
            break;
        }
        usleep(2000);
    }
    return running.wait();
}

CommandResult runToolOnFullDisk(const std::string& tool, const std::vector<std::string>& arguments,
                                std::size_t bytes) {
    // Through a pipe: what the tool says goes into a file as well.
    std::string line = "set -o pipefail; (trap '' XFSZ; ulimit -f " + std::to_string(bytes / 1024) +
                       "; exec '" + toolPath(tool) + "'";
    for (const auto& word : arguments) line += " '" + word + "'";
    return runTool("bash", {"-c", line + ") 2>&1 | cat >&2"});
}

bool isOneLine(const std::string& err) {
    return !err.empty() && err.back() == '\n' && std::count(err.begin(), err.end(), '\n') == 1;
}

std::string errorOf(const CommandResult& result) {
    static const std::regex progress(
        "[a-z0-9-]+: (warning: .*|reading .*|[a-z]+ [0-9]+(/[0-9]+)?)");
    std::istringstream lines(result.err);
    std::string rest;
    for (std::string line; std::getline(lines, line);)
        if (!std::regex_match(line, progress)) rest += line + "\n";
    return rest;
}

void expectFailure(const CommandResult& result, int exitCode,
                   const std::vector<std::string>& words) {
    EXPECT_EQ(result.exitCode, exitCode) << result.err;
    const std::string error = errorOf(result);
    EXPECT_TRUE(isOneLine(error)) << error;
    for (const auto& word : words)
        EXPECT_NE(error.find(word), std::string::npos) << word << "\n" << error;
}
}  // namespace delio::test
