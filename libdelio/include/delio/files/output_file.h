#pragma once
#include <functional>
#include <iosfwd>
#include <string>

namespace delio::io {
/** Lets `write` fill a file of the same name in a PartialFolder beside `path`, then renames it to
 *  `path`: what stands under `path` is always whole. If `write` throws, returns false or the disk
 *  is full, nothing is left of it, and Error names the path. */
void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write);

/** The same for text: `write` gets a stream in the "C" locale. */
void replaceTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);

/** Waits until a file, or what a folder says of its files, is on the disk, where power that fails
 *  leaves it. Error where that fails. */
void putOnDisk(const std::string& path);
}  // namespace delio::io
