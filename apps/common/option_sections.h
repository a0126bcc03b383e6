#pragma once
#include <string>
#include <vector>

#include "delio/odometry/odometry.h"
#include "help_text.h"

namespace delio::cli {
/** The names of the profiles, with '|' between. */
std::string profileChoice();

/** The sections of --set with what each is about, in the order of `stages`. */
std::vector<HelpText::Row> optionSections(const ConstStageList& stages);
}  // namespace delio::cli
