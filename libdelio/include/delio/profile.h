#pragma once
#include <iosfwd>
#include <map>
#include <string>

#include "delio/odometry.h"

namespace delio {
/** The text of each share/config/NAME.ini, by NAME. */
const std::map<std::string, std::string>& profileTexts();
}  // namespace delio
