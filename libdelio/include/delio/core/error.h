#pragma once
#include <exception>
#include <stdexcept>
#include <string>

namespace delio {
/** What went wrong with an input or an output, as one plain line: what, where and what to do.
 *  Everything in delio that refuses its input throws this. */
class Error : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/** What an exception says in one line: of an Error its own; of any other (of MRPT, yaml-cpp, the
 *  standard library) the same in words that a user knows, without frame and stack trace. */
std::string plainMessage(const std::exception& e);
}  // namespace delio
