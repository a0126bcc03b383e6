#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace delio::io {
/** Takes the next line that is not blank off `rest`, without its end; nothing where there is none.
 *  `passed`: how many lines were taken, blank ones included, is added to it. */
std::optional<std::string_view> nextLine(std::string_view& rest, std::size_t* passed = nullptr);

/** What numbersIn() gives for a line that holds something else. */
constexpr std::size_t kNoNumbers = static_cast<std::size_t>(-1);

/** How many numbers a line has, whatever the locale; they are written to `values`, as many as it
 *  holds (NaN for one too large for a double). Between them: spaces, tabs, and at most one comma or
 * semicolon. */
std::size_t numbersIn(std::string_view line, std::vector<double>& values);

/** The words of such a line. */
std::vector<std::string_view> wordsIn(std::string_view line);

/** Unix seconds of "2011-09-26 13:02:25.951199337", as KITTI raw writes dates (UTC is assumed: it
 *  gives no zone); nothing where `text` does not begin with a date and time. */
std::optional<double> unixTimeOfDate(const std::string& text);
}  // namespace delio::io
