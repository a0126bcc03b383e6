#pragma once
#include <string>

namespace delio::picture {
/** 1, 2 or 5 times a power of ten, near to the length. */
double roundLength(double length_m);

/** "50 m", "0.2 m", "2 km". */
std::string metresText(double length_m);
}  // namespace delio::picture
