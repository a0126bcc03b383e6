#pragma once
#include <exception>
#include <stdexcept>
#include <string>

namespace delio {
/** Error with one plain line: what failed, where, and what to do. Everything in delio that rejects
 *  its input throws it. */
class Error : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/** One-line message of an exception: an Error's own; for others (MRPT, yaml-cpp, the standard
 *  library) a plain translation without stack trace. */
std::string plainMessage(const std::exception& e);
}  // namespace delio
