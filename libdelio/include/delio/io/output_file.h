#pragma once
#include <functional>
#include <iosfwd>
#include <string>

namespace delio::io {
/** Lets `write` fill a file under a temporary name beside `path` (same extension, so that writers
 *  that look at it work), then renames it to `path`: what stands under `path` is always whole. If
 *  `write` throws, returns false or the disk is full, the temporary is removed, and Error names
 *  the path. */
void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write);

/** The same for text: `write` gets a stream in the "C" locale. */
void replaceTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);
}  // namespace delio::io
