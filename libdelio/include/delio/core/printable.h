#pragma once
#include <string>

namespace delio {
/** `text` with '?' for every control character and every byte that is not UTF-8: fit for a line of
 *  a terminal, of a script and of a document. */
std::string printable(const std::string& text);
}  // namespace delio
