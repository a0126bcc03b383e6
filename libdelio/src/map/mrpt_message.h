#pragma once
#include <exception>
#include <string>

namespace delio::map {
/** What an exception says, without the frame and the stack trace that MRPT lays around it. */
inline std::string messageOf(const std::exception& e) {
    const std::string what = e.what(), mark = "Message:";
    auto from = what.find(mark);
    from = from == std::string::npos ? 0 : what.find_first_not_of(' ', from + mark.size());
    return what.substr(from, what.find('\n', from) - from);
}
}  // namespace delio::map
