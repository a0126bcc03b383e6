#pragma once
#include <cstddef>
#include <string>

namespace delio {
/** `text` with '?' for control characters and invalid UTF-8: safe for terminals, scripts and
 *  documents. */
std::string printable(const std::string& text);

/** printable(`text`) with HTML's special characters (& < > ") escaped. */
std::string htmlText(const std::string& text);

/** `text`, shortened to `most` bytes: the first two thirds, "...", and the last third. */
std::string shortened(const std::string& text, std::size_t most);
}  // namespace delio
