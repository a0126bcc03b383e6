#pragma once
#include <optional>
#include <string>

namespace delio::io {
/** Unix seconds of "2011-09-26 13:02:25.951199337", as KITTI raw writes dates (UTC is assumed: it
 *  gives no zone); nothing where `text` does not begin with a date and time. */
std::optional<double> unixTimeOfDate(const std::string& text);
}  // namespace delio::io
