#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace delio::io {
/** The rules for names that files of others hold, before anything is read or written by them. */

/** `name` is that of one file or folder in whatever folder it is put into: not empty, not "." or
 *  "..", without a slash and without control characters. */
bool isFileName(const std::string& name);

/** `name` leads to something within the folder that it is looked for in: it is relative, and no
 *  part of it is "..". */
bool staysInside(const std::filesystem::path& name);

/** True where `a` comes before `b` as people count: scan2 before scan10, however long the numbers
 *  are. Names that differ in leading zeros only are in the order of their characters. */
bool naturallyBefore(std::string_view a, std::string_view b);
}  // namespace delio::io
