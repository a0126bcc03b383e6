#pragma once
#include <map>
#include <string>

namespace delio {
/** The text of each share/config/NAME.ini, by NAME; CMake puts them in. */
const std::map<std::string, std::string>& profileTexts();
}  // namespace delio
