#pragma once
#include <stdexcept>
#include <string>

namespace delio {
/** What went wrong with an input or an output, as one plain line: what, where and what to do.
 *  Everything in delio that refuses its input throws this. */
class Error : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/** What an exception says in one line, without the frame and the stack trace that MRPT lays around
 *  it. */
inline std::string plainMessage(const std::exception& e) {
    const std::string what = e.what(), mark = "Message:";
    auto from = what.find(mark);
    from = from == std::string::npos ? 0 : what.find_first_not_of(' ', from + mark.size());
    return what.substr(from, what.find('\n', from) - from);
}
}  // namespace delio
