#pragma once
#include <string>

namespace delio::io {
enum class FileKind { kRawlog, kPcap, kRos1Bag, kRos2Database, kMcap };

/** What a file is by its first bytes; "-": standard input, of which nothing is taken. What is none
 *  of the others is taken for a rawlog, which has no mark of its own. Throws Error where it cannot
 *  be read, or is a single cloud or another format that is known but not read. */
FileKind kindOf(const std::string& path);
}  // namespace delio::io
