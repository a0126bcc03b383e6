#pragma once
#include <mrpt/3rdparty/tclap/CmdLineOutput.h>

#include <string>

#include "help_text.h"

namespace delio::cli {
/** Command-line output of a program: help in GNU's form (help2man turns it into a manual page),
 *  version, and failures in one plain line. */
class CommandLineOutput : public TCLAP::CmdLineOutput {
 public:
    /** `cmd`: not parsed yet, the values of its arguments are the defaults. */
    CommandLineOutput(TCLAP::CmdLineInterface& cmd, const HelpText& text);

    void usage(TCLAP::CmdLineInterface& cmd) override;
    void version(TCLAP::CmdLineInterface& cmd) override;
    void failure(TCLAP::CmdLineInterface& cmd, TCLAP::ArgException& e) override;
    bool hasFailed() const { return failed_; }

 private:
    std::string help_;
    bool failed_ = false;
};
}  // namespace delio::cli
