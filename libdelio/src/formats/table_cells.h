#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace delio::io {
/** The cells of a line of a .csv, whatever ends it. */
std::vector<std::string> cellsOf(const std::string& line);

/** A text that stays in its cell: a comma becomes ';' and a line end a space. */
std::string cellOf(std::string text);

/** Number of a column. Error where `path`, which should be delio-slam's `kind`, has none of that
 *  name. */
std::size_t columnOf(const std::vector<std::string>& heading, const std::string& name,
                     const std::string& path, const std::string& kind);
}  // namespace delio::io
