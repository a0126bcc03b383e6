#pragma once
#include <filesystem>
#include <string>

namespace delio::io {
/** The rules for names that files of others hold, before anything is read or written by them. */

/** `name` is that of one file or folder in whatever folder it is put into: not empty, not "." or
 *  "..", without a slash and without control characters. */
bool isFileName(const std::string& name);

/** `name` leads to something within the folder that it is looked for in: it is relative, and no
 *  part of it is "..". */
bool staysInside(const std::filesystem::path& name);
}  // namespace delio::io
