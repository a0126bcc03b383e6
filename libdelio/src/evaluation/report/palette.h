#pragma once
#include <cstddef>
#include <string>

namespace delio::evaluation {
/** The colour of an estimate in every plot and table, "#rrggbb": colours that people who do not
 *  tell red from green tell apart. They come again after the eighth estimate. Red is left to the
 *  ground truth. */
std::string colourOf(std::size_t estimate);

/** The same, mixed with white: for what lies in the background. */
std::string paleColourOf(std::size_t estimate);

constexpr const char* kTruthColour = "#e03131";
}  // namespace delio::evaluation
