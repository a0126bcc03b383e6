#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "test_data.h"
#include "toy_drive.h"

namespace delio::test {
/** A csv as columns by their names. */
inline std::map<std::string, std::vector<std::string>> csvColumns(
    const std::filesystem::path& file) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& line : linesOf(readText(file))) {
        rows.emplace_back();
        std::istringstream cells(line + ",");
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    std::map<std::string, std::vector<std::string>> columns;
    for (std::size_t c = 0; c < rows[0].size(); ++c)
        for (std::size_t r = 1; r < rows.size(); ++r) {
            EXPECT_EQ(rows[r].size(), rows[0].size()) << "row " << r;
            columns[rows[0][c]].push_back(rows[r].at(c));
        }
    return columns;
}
}  // namespace delio::test
