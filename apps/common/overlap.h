#pragma once
#include <string>
#include <vector>

namespace delio::cli {
/** Throws Error if one of `outputs` (files and folders that will be replaced) is or contains one of
 *  `inputs`, or the target of a link in an input folder, by any name. Missing files are ignored. */
void refuseOverlap(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/** The rawlog at `path` and what may be read beside it. */
std::vector<std::string> filesOfRawlog(const std::string& path);
}  // namespace delio::cli
