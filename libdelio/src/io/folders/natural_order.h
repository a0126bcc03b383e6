#pragma once
#include <string_view>

namespace delio::io {
/** True where `a` comes before `b` as people count: scan2 before scan10, however long the numbers
 *  are. Names that differ in leading zeros only are in the order of their characters. */
bool naturallyBefore(std::string_view a, std::string_view b);
}  // namespace delio::io
