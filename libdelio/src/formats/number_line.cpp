#include "number_line.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>

#include "delio/core/text.h"

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

/** Result for numbers outside the range of double: 0 if too small, NaN if too large. */
double beyondRange(std::string_view number) {
    const auto exponent = number.find_first_of("eE");
    const bool small = exponent == number.npos ? number.find('.') < 300
                                               : number.find('-', exponent) != number.npos;
    return small ? 0 : std::numeric_limits<double>::quiet_NaN();
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
        if (parsed.ec == std::errc::invalid_argument) return kNoNumbers;
        if (parsed.ec == std::errc::result_out_of_range)
            value = beyondRange({at, static_cast<std::size_t>(parsed.ptr - at)});
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

std::vector<std::string> cellsIn(std::string_view line) {
    std::vector<std::string> cells{""};
    for (const char c : line)
        if (isSeparator(c))
            cells.emplace_back();
        else if (c != '"' && !isBlank(c))
            cells.back() += c;
    return cells;
}

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::optional<double> unixTimeOfDate(const std::string& text) {
    std::tm date{};
    char fraction[16] = "0";
    if (std::sscanf(text.c_str(), "%d-%d-%d %d:%d:%d.%15[0-9]", &date.tm_year, &date.tm_mon,
                    &date.tm_mday, &date.tm_hour, &date.tm_min, &date.tm_sec, fraction) < 6)
        return {};
    date.tm_year -= 1900;
    date.tm_mon -= 1;
    return static_cast<double>(timegm(&date)) + *numberIn<double>(std::string("0.") + fraction);
}

std::string dateOf(double unix_s) {
    const auto seconds = static_cast<std::time_t>(std::floor(unix_s));
    std::tm date{};
    char text[64] = "";
    if (gmtime_r(&seconds, &date)) std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &date);
    return text;
}

std::optional<double> unixTimeIn(const std::string& text) {
    if (const auto seconds = numberIn<double>(text))
        return *seconds > 0 && std::isfinite(*seconds) ? seconds : std::nullopt;
    std::string date = text;
    if (!date.empty() && date.back() == 'Z') date.pop_back();
    for (const char* format : {"%Y-%m-%dT%H:%M:%S", "%Y-%m-%dT%H:%M", "%Y-%m-%d"}) {
        std::tm parts{};
        const char* const end = strptime(date.c_str(), format, &parts);
        if (!end || *end != '\0') continue;
        const std::tm given = parts;
        const double seconds = static_cast<double>(timegm(&parts));
        // There is no 31st of April.
        if (seconds > 0 && parts.tm_mday == given.tm_mday) return seconds;
    }
    return {};
}
}  // namespace delio::io
