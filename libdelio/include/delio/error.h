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
}  // namespace delio
