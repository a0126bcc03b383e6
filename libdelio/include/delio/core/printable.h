#pragma once
#include <cstddef>
#include <string>

namespace delio {
/** `text` with '?' for every control character and every byte that is not UTF-8: fit for a line of
 *  a terminal, of a script and of a document. */
std::string printable(const std::string& text);

/** printable(`text`) with the characters that HTML gives a meaning (& < > ") escaped. */
std::string htmlText(const std::string& text);

/** `text`, or where it has more than `most` bytes its first two thirds of them and its last third,
 *  with "..." between. */
std::string shortened(const std::string& text, std::size_t most);
}  // namespace delio
