#pragma once
#include <cstddef>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "help_text.h"

namespace TCLAP {
class CmdLine;
class SwitchArg;
}  // namespace TCLAP

/** Common behaviour of all programs: exit, failure, interruption and progress. Results go to
 *  stdout, everything else to stderr. */
namespace delio::cli {
constexpr int kExitSuccess = 0;
constexpr int kExitFailedRun = 1;
constexpr int kExitBadCommandLine = 2;
constexpr int kExitInterrupted = 130;
constexpr unsigned kMostThreads = 4096;  //!< that a --threads may ask for

/** How many of something, on the command line. TCLAP reads `-1` into an unsigned as 4294967295:
 * here it is refused. */
struct Count {
    unsigned value = 0;
    operator unsigned() const { return value; }
};
std::istream& operator>>(std::istream& in, Count& count);

/** The numbers in a text of `count` finite numbers with commas between; otherwise empty. */
std::vector<double> numbersIn(std::string text, std::size_t count);

/** Runs a tool: parses the command line into `cmd` (whose arguments the caller has added; `help`
 *  says the rest of --help), then calls `body`, and turns every ending into the contract's exit
 * code and one line on stderr: what() of a delio::Error, plainMessage() of any other exception (all
 * of it if `verbose` is set).
 */
int run(TCLAP::CmdLine& cmd, const HelpText& help, int argc, const char* const* argv,
        TCLAP::SwitchArg& verbose, const std::function<int()>& body);

/** From now on Ctrl-C (SIGINT, SIGTERM) ends the process at once, with kExitInterrupted: nothing is
 *  done yet that is worth writing. run() begins with it. */
void endAtInterrupt();
/** From now on the first Ctrl-C makes interrupted() true, and a second one, half a second later or
 *  more, ends the process at once. */
void catchInterrupts();
bool interrupted();
/** Ctrl-C ends standard input, too, where that is a pipe: nothing waits for it any longer. To be
 *  called once, before standard input is read. */
void endInputAtInterrupt();

/** One line on stderr: `TOOL: warning: TEXT`. */
void warn(const std::string& text);

/** One line on stderr: `TOOL: TEXT`. */
void inform(const std::string& text);

/** Throws Error if `path` exists and `force` is false; the message names --force. */
void refuseExisting(const std::string& path, bool force);

/** A bar with the time left on a terminal; otherwise a plain line every ten percent. */
class Progress {
 public:
    /** `total` of 0: not known. */
    Progress(std::string what, std::size_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /** `fraction`: of the whole work, 0 to 1, where `total` is not known but this is. */
    void update(std::size_t done, std::optional<double> fraction = {});

 private:
    std::string what_;
    std::size_t total_;
    bool terminal_;
    double begin_s_;
    double lastShown_s_ = -1;
    double nextLine_ = 0.1;
};
}  // namespace delio::cli
