#include "delio/evaluation/report/report.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "delio/core/numbers.h"

namespace delio::evaluation {
namespace {
using Cells = std::vector<std::string>;

std::string number(double value, int decimals) {
    return std::isfinite(value) ? fixed(value, decimals) : "-";
}

Cells cellsOf(const ReportRow& row, int decimals) {
    return {row.name,
            row.sequence,
            number(row.length_m, decimals),
            std::to_string(row.kitti.segments),
            number(row.kitti.t_percent, decimals),
            number(row.kitti.r_deg_per_100m, decimals),
            number(row.ape_m, decimals),
            number(row.rpe_m, decimals),
            number(row.rpe_deg, decimals)};
}

void writeLine(const Cells& cells, std::ostream& out) {
    const char* separator = "";
    for (const auto& cell : cells) {
        out << separator << cell;
        separator = "\t";
    }
    out << '\n';
}

constexpr int kTsvDecimals = 9;
constexpr int kTableDecimals = 4;
}  // namespace

void writeMetricsTsv(const std::vector<ReportRow>& rows, std::ostream& out) {
    writeLine({"name", "sequence", "length_m", "segments", "t_percent", "r_deg_per_100m", "ape_m",
               "rpe_m", "rpe_deg"},
              out);
    for (const auto& row : rows) writeLine(cellsOf(row, kTsvDecimals), out);
}

void writeLengthsTsv(const std::vector<ReportRow>& rows, std::ostream& out) {
    writeLine({"name", "sequence", "segment_length_m", "segments", "t_percent", "r_deg_per_100m"},
              out);
    for (const auto& row : rows)
        for (const auto& errors : row.kitti.perLength)
            writeLine({row.name, row.sequence, number(errors.length_m, kTsvDecimals),
                       std::to_string(errors.segments), number(errors.t_percent, kTsvDecimals),
                       number(errors.r_deg_per_100m, kTsvDecimals)},
                      out);
}

void writeTable(const std::vector<ReportRow>& rows, std::ostream& out) {
    std::vector<Cells> lines = {{"name", "sequence", "length [m]", "segments", "translation [%]",
                                 "rotation [deg/100 m]", "APE [m]", "RPE [m]", "RPE [deg]"}};
    for (const auto& row : rows) lines.push_back(cellsOf(row, kTableDecimals));
    std::vector<std::size_t> widths(lines.front().size(), 0);
    for (const auto& cells : lines)
        for (std::size_t i = 0; i < cells.size(); ++i)
            widths[i] = std::max(widths[i], cells[i].size());
    for (const auto& cells : lines) {
        std::string text;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::string padding(widths[i] - cells[i].size(), ' ');
            if (i > 0) text += "  ";
            text += i < 2 ? cells[i] + padding : padding + cells[i];  // words left, numbers right
        }
        out << text << '\n';
    }
}
}  // namespace delio::evaluation
