#pragma once
#include <string_view>

namespace delio::io {
enum class FileOf { Scans, Keyframes, Scene };

/** Whether such a file may hold objects of this class of MRPT (its name with namespaces). What is
 *  not needed is not made: some of MRPT's classes open other files, or crash on damaged ones. */
bool isKnown(std::string_view className, FileOf file);
}  // namespace delio::io
