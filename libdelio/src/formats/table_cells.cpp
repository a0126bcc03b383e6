#include "table_cells.h"

#include <algorithm>

#include "delio/core/error.h"

namespace delio::io {
std::vector<std::string> cellsOf(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
        if (c == ',')
            cells.emplace_back();
        else if (c != '\r')
            cells.back() += c;
    }
    return cells;
}

std::string cellOf(std::string text) {
    for (char& c : text) {
        if (c == ',') c = ';';
        if (c == '\n' || c == '\r') c = ' ';
    }
    return text;
}

std::size_t columnOf(const std::vector<std::string>& heading, const std::string& name,
                     const std::string& path, const std::string& kind) {
    const auto found = std::find(heading.begin(), heading.end(), name);
    if (found == heading.end())
        throw Error("'" + path + "' has no column '" + name + "'; it must be delio-slam's " + kind +
                    "?");
    return static_cast<std::size_t>(found - heading.begin());
}
}  // namespace delio::io
