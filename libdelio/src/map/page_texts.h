#pragma once
#include <map>
#include <string>

namespace delio::map {
/** The files of share/page by name, as they were when the library was built. */
const std::map<std::string, std::string>& pageTexts();
}  // namespace delio::map
