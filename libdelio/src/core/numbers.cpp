#include "delio/core/numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio {
namespace {
std::string written(double value, std::chars_format format, int precision) {
    std::string text(
        static_cast<std::size_t>(precision) + std::numeric_limits<double>::max_exponent10 + 16,
        '\0');
    char* const end = text.data() + text.size();
    text.resize(static_cast<std::size_t>(
        std::to_chars(text.data(), end, value, format, precision).ptr - text.data()));
    return text;
}
}  // namespace

std::string fixed(double value, int decimals) {
    return written(value, std::chars_format::fixed, decimals);
}

std::string rounded(double value, int digits) {
    return written(value, std::chars_format::general, digits);
}

std::vector<double> numbersIn(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n\v\f";
    std::vector<double> numbers;
    for (;;) {
        text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
        const auto number = numberIn<double>(text.substr(0, text.find_first_of(kSpace)));
        if (!number || !std::isfinite(*number)) return numbers;
        numbers.push_back(*number);
        text.remove_prefix(std::min(text.find_first_of(kSpace), text.size()));
    }
}
}  // namespace delio
