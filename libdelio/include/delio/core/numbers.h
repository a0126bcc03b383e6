#pragma once
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace delio {
/** The number that all of `text` is, whatever the locale; nothing where it is anything else: empty,
 *  with spaces or a tail, out of the type's range. A leading '+' is no number. `Number`: double or
 *  a whole number; a double may be NaN or infinite where the text says so. */
template <typename Number>
std::optional<Number> numberIn(std::string_view text) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (text.empty() || parsed.ec != std::errc{} || parsed.ptr != end) return {};
    return value;
}

/** The fewest digits that give the same number back when they are read again. */
template <typename Number>
std::string digitsOf(Number value) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

/** With so many decimals, whatever the locale: as printf's "%.*f" in the locale "C". */
std::string fixed(double value, int decimals);

/** With so many significant digits, whatever the locale: as printf's "%.*g" in the locale "C". */
std::string rounded(double value, int digits);

/** All finite numbers that `text` begins with, separated by white space, whatever the locale: up to
 *  its end, or to the first word that is anything else. */
std::vector<double> numbersIn(std::string_view text);
}  // namespace delio
