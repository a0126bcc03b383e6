#include "delio/core/text.h"

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

/** Bytes of the character of UTF-8 that begins with `lead`; 0 for none. */
std::size_t lengthOf(unsigned char lead) {
    if (lead < 0x80) return 1;
    if (lead >= 0xC2 && lead < 0xE0) return 2;
    if (lead >= 0xE0 && lead < 0xF0) return 3;
    return lead >= 0xF0 && lead < 0xF5 ? 4 : 0;
}

/** True if a complete UTF-8 character of `length` bytes starts at `i` (surrogates and overlong
 *  forms are rejected). */
bool isCharacter(const std::string& text, std::size_t i, std::size_t length) {
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
        if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return false;
    if (length < 3) return true;
    const auto lead = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(text[i + 1]);
    return !(lead == 0xE0 && next < 0xA0) && !(lead == 0xED && next >= 0xA0) &&
           !(lead == 0xF0 && next < 0x90) && !(lead == 0xF4 && next >= 0x90);
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

std::string printable(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lengthOf(lead);
        const bool whole = isCharacter(text, i, length);
        // Those of two bytes begin with C2 80.
        const bool isControl =
            lead < 0x20 || lead == 0x7F ||
            (whole && lead == 0xC2 && static_cast<unsigned char>(text[i + 1]) < 0xA0);
        if (!whole || isControl) {
            result += '?';
            i += whole ? length : 1;
        } else {
            result += text.substr(i, length);
            i += length;
        }
    }
    return result;
}

std::string htmlText(const std::string& text) {
    std::string result;
    for (const char c : printable(text)) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

std::string shortened(const std::string& text, std::size_t most) {
    if (text.size() <= most) return text;
    const auto continues = [&](std::size_t i) {
        return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
    };
    // Characters stay whole.
    std::size_t head = most - most / 3, tail = text.size() - most / 3;
    while (head > 0 && continues(head)) --head;
    while (continues(tail)) ++tail;
    return text.substr(0, head) + "..." + text.substr(tail);
}
}  // namespace delio
