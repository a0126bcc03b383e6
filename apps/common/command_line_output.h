#pragma once
#include <mrpt/3rdparty/tclap/CmdLineOutput.h>

#include <string>

#include "help_text.h"

namespace delio::cli {
/** What a tool says of its command line: help in GNU's form, which help2man makes a manual page of;
 *  a version and a failure in one plain line. */
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
