#pragma once
#include <string>

namespace delio::evaluation {
/** `text` with '?' for every control character and every byte that is not UTF-8: fit for a line of
 *  a script and for a document. */
std::string printable(const std::string& text);
}  // namespace delio::evaluation
