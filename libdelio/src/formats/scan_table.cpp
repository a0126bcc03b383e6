#include "delio/formats/scan_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "table_cells.h"

namespace delio::io {
namespace {
bool sameColumns(const ScanRow& a, const ScanRow& b) {
    return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                      [](const auto& one, const auto& other) { return one.first == other.first; });
}
}  // namespace

ScanTable readScanTable(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::string text;
    std::getline(in, text);
    const auto heading = cellsOf(text);
    const std::size_t columns[] = {columnOf(heading, "scan", path, "scans.csv"),
                                   columnOf(heading, "stamp_s", path, "scans.csv"),
                                   columnOf(heading, "predicted", path, "scans.csv")};
    ScanTable table;
    for (std::size_t line = 2; std::getline(in, text); ++line) {
        // The reason, the last column, may contain commas: columns after the needed ones are not
        // checked.
        const auto cells = cellsOf(text);
        double values[3] = {};
        for (int i = 0; i < 3; ++i) {
            const std::string cell = columns[i] < cells.size() ? cells[columns[i]] : "";
            const auto number = numberIn<double>(cell);
            if (!number || !std::isfinite(*number))
                throw Error("'" + path + "', line " + std::to_string(line) + ": '" +
                            heading[columns[i]] + "' is not a number");
            values[i] = *number;
        }
        const double scan = values[0];
        if (scan < 0 || scan > 1e9 || scan != std::floor(scan) ||
            (!table.scans.empty() && scan <= static_cast<double>(table.scans.back())))
            throw Error("'" + path + "', line " + std::to_string(line) +
                        ": scan numbers must increase");
        table.scans.push_back(static_cast<std::size_t>(scan));
        table.stamps_s.push_back(values[1]);
        table.predicted.push_back(values[2] != 0);
    }
    return table;
}

std::string scanTableHeading(const ScanRow& row) {
    std::string line = "scan,stamp_s";
    for (const auto& value : row.values) line += ',' + cellOf(value.first);
    return line + ",predicted,reason\n";
}

std::string scanTableLine(const ScanRow& row) {
    std::string line = std::to_string(row.scan) + ',' + fixed(row.stamp_s, 7);
    for (const auto& value : row.values) line += ',' + cellOf(value.second);
    return line + (row.predicted ? ",1," : ",0,") + cellOf(row.reason) + '\n';
}

void writeScanTable(std::size_t rows, const std::function<ScanRow(std::size_t)>& rowAt,
                    const std::string& path) {
    replaceTextFile(path, [&](std::ostream& out) {
        const ScanRow first = rows > 0 ? rowAt(0) : ScanRow();
        out << scanTableHeading(first);
        for (std::size_t i = 0; i < rows; ++i) {
            const ScanRow row = rowAt(i);
            if (!sameColumns(row, first))
                throw Error("cannot write '" + path + "': scan " + std::to_string(row.scan) +
                            " has other columns than the first scan");
            out << scanTableLine(row);
        }
    });
}
}  // namespace delio::io
