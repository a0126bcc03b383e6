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
}  // namespace delio::io
