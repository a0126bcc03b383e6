#include "number_line.h"

#include <charconv>
#include <cstring>

namespace delio::io {
namespace {
bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool isSeparator(char c) { return c == ',' || c == ';'; }

/** Past blanks and, with them, one separator. */
const char* pastGap(const char* at, const char* end) {
    while (at != end && isBlank(*at)) ++at;
    if (at == end || !isSeparator(*at)) return at;
    ++at;
    while (at != end && isBlank(*at)) ++at;
    return at;
}
}  // namespace

std::optional<std::string_view> nextLine(std::string_view& rest, std::size_t* passed) {
    while (!rest.empty()) {
        const void* found = std::memchr(rest.data(), '\n', rest.size());
        const std::size_t length =
            found ? static_cast<std::size_t>(static_cast<const char*>(found) - rest.data())
                  : rest.size();
        const auto line = rest.substr(0, length);
        rest.remove_prefix(found ? length + 1 : length);
        if (passed) ++*passed;
        if (line.find_first_not_of(" \t\r") != line.npos) return line;
    }
    return {};
}

std::size_t numbersIn(std::string_view line, std::vector<double>& values) {
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at != end && isBlank(*at)) ++at;
    std::size_t count = 0;
    while (at != end) {
        double value = 0;
        if (*at == '+' && at + 1 != end && at[1] != '-') ++at;
        const auto parsed = std::from_chars(at, end, value);
        // What is too small or too large for a double is not worth an error.
        if (parsed.ec == std::errc::invalid_argument) return kNoNumbers;
        at = parsed.ptr;
        if (at != end && !isBlank(*at) && !isSeparator(*at)) return kNoNumbers;
        if (count < values.size()) values[count] = value;
        ++count;
        at = pastGap(at, end);
    }
    return count;
}

std::vector<std::string_view> wordsIn(std::string_view line) {
    std::vector<std::string_view> words;
    const char* at = line.data();
    const char* const end = at + line.size();
    while (at != end && isBlank(*at)) ++at;
    while (at != end) {
        const char* const begin = at;
        while (at != end && !isBlank(*at) && !isSeparator(*at)) ++at;
        words.emplace_back(begin, static_cast<std::size_t>(at - begin));
        at = pastGap(at, end);
    }
    return words;
}
}  // namespace delio::io
