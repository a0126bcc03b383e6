#pragma once
#include <functional>
#include <iosfwd>
#include <string>

namespace delio::io {
/** Lets `write` fill a file of the same name in a PartialFolder beside `path`, then renames it to
 *  `path`: the file at `path` is always complete. If `write` throws, returns false or the disk is
 *  full, no file remains, and Error names the path. */
void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write);

/** The same for text: `write` gets a stream in the "C" locale. */
void replaceTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);

/** Flushes a file, or a folder's entries, to disk (fsync). Throws Error if that fails. */
void putOnDisk(const std::string& path);
}  // namespace delio::io
