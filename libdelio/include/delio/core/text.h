#pragma once
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace delio {
/** Parses all of `text` as a number, independent of the locale; nothing if it is empty, has spaces
 *  or a tail, or is out of range. A leading '+' is not accepted. `Number`: double or an integer
 *  type; a double may be NaN or infinite. */
template <typename Number>
std::optional<Number> numberIn(std::string_view text) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (text.empty() || parsed.ec != std::errc{} || parsed.ptr != end) return {};
    return value;
}

/** Shortest text that parses to the same number. */
template <typename Number>
std::string digitsOf(Number value) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

/** Text with this many decimals, independent of the locale: as printf's "%.*f" in the locale "C".
 */
std::string fixed(double value, int decimals);

/** Text with this many significant digits, independent of the locale: as printf's "%.*g" in the
 *  locale "C". */
std::string rounded(double value, int digits);

/** Leading finite numbers of `text`, separated by white space, independent of the locale; stops at
 *  the first other word. */
std::vector<double> numbersIn(std::string_view text);

/** `text` with '?' for control characters and invalid UTF-8: safe for terminals, scripts and
 *  documents. */
std::string printable(const std::string& text);

/** printable(`text`) with HTML's special characters (& < > ") escaped. */
std::string htmlText(const std::string& text);

/** `text`, shortened to `most` bytes: the first two thirds, "...", and the last third. */
std::string shortened(const std::string& text, std::size_t most);
}  // namespace delio
