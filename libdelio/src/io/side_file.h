#pragma once
#include <string>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** The text of the file at `path`; none where there is no such file. Throws Error where it cannot
 *  be read. */
SideFile sideFile(const std::string& path);
}  // namespace delio::io
