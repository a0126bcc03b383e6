#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace delio::io {
/** Removes the next non-blank line from `rest` and returns it without its end; nothing at the end.
 *  Adds the number of lines removed, blank ones included, to `passed`. */
std::optional<std::string_view> nextLine(std::string_view& rest, std::size_t* passed = nullptr);

/** Result of numbersIn() for lines with other content. */
constexpr std::size_t kNoNumbers = static_cast<std::size_t>(-1);

/** How many numbers a line has, whatever the locale; they are written to `values`, as many as it
 *  holds (NaN for one too large for a double). Between them: spaces, tabs, and at most one comma or
 * semicolon. */
std::size_t numbersIn(std::string_view line, std::vector<double>& values);

/** The words of such a line. */
std::vector<std::string_view> wordsIn(std::string_view line);

/** The cells of a line of a CSV, between commas or semicolons, without quotes and blanks. */
std::vector<std::string> cellsIn(std::string_view line);

/** The cell in lower case, as the name of a column. */
std::string lowerCase(std::string text);

/** Unix seconds of "2011-09-26 13:02:25.951199337", as KITTI raw writes dates (UTC is assumed: it
 *  gives no zone); nothing where `text` does not begin with a date and time. */
std::optional<double> unixTimeOfDate(const std::string& text);

/** "2011-09-26T13:02:25Z": of Unix seconds, rounded down. */
std::string dateOf(double unix_s);

/** Unix seconds of "2011-09-26T13:02:25Z" (UTC; the Z, the seconds, or the time of day may be
 *  missing), or of a number of Unix seconds; nothing for other texts. */
std::optional<double> unixTimeIn(const std::string& text);
}  // namespace delio::io
