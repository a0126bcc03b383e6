#pragma once
#include <string>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** True where there is a file at `path`. Throws Error where something else is there: a pipe would
 * be waited for, a device has no end. For files that nobody has named but that are looked for. */
bool isFileThere(const std::string& path);

/** The text of the file at `path`; none where there is no such file. Throws Error where it cannot
 *  be read. */
SideFile sideFile(const std::string& path);
}  // namespace delio::io
