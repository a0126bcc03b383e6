#pragma once
#include <string>

#include "delio/files/output.h"

namespace delio {
/** The folder for results is made at once, so that an unwritable one is found before the work is
 *  done; one that was made for nothing is taken away again. No other run can have it meanwhile. */
class OutputFolder {
 public:
    /** Throws Error where it cannot be written into, or is not empty without `force`. */
    OutputFolder(const std::string& folder, bool force);

 private:
    io::TargetFolder folder_;
};
}  // namespace delio
