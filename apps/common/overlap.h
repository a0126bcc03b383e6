#pragma once
#include <string>
#include <vector>

namespace delio::cli {
/** Throws Error where one of `outputs`, files and folders that will be replaced, is one of `inputs`
 *  or holds it, or what a link in an input folder leads to, whatever the names. Names of what is
 *  not there do no harm. */
void refuseOverlap(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/** The rawlog at `path` and what may be read beside it. */
std::vector<std::string> filesOfRawlog(const std::string& path);
}  // namespace delio::cli
