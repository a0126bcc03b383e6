#include "delio/evaluation/report.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "delio/evaluation/absolute_error.h"
#include "delio/evaluation/relative_error.h"

namespace delio::evaluation {
namespace {
using Cells = std::vector<std::string>;

std::string number(double value, int decimals) {
    return std::isfinite(value) ? mrpt::format("%.*f", decimals, value) : "-";
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

/** Mean of those of the rows' figures that exist. */
template <typename Figure>
double meanOf(const std::vector<ReportRow>& rows, const Figure& figure) {
    double sum = 0, count = 0;
    for (const auto& row : rows) {
        if (!std::isfinite(figure(row))) continue;
        sum += figure(row);
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

constexpr int kTsvDecimals = 9;
constexpr int kTableDecimals = 4;
}  // namespace

ReportRow score(const std::vector<mrpt::poses::CPose3D>& reference,
                const std::vector<mrpt::poses::CPose3D>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta) {
    const auto relative = relativeError(reference, estimate, delta);
    ReportRow row;
    row.length_m = pathLength_m(reference);
    row.kitti = kittiErrors(reference, estimate, lengths_m);
    row.ape_m = absoluteError(reference, estimate).rmse_m;
    row.rpe_m = relative.translation_m.rmse;
    row.rpe_deg = relative.rotation_deg.rmse;
    return row;
}

ReportRow averageOf(const std::vector<ReportRow>& rows) {
    ReportRow average;
    average.name = rows.front().name;
    average.sequence = "avg";
    for (const auto& row : rows) {
        average.length_m += row.length_m;
        average.kitti.segments += row.kitti.segments;
    }
    average.kitti.t_percent = meanOf(rows, [](const ReportRow& r) { return r.kitti.t_percent; });
    average.kitti.r_deg_per_100m =
        meanOf(rows, [](const ReportRow& r) { return r.kitti.r_deg_per_100m; });
    average.ape_m = meanOf(rows, [](const ReportRow& r) { return r.ape_m; });
    average.rpe_m = meanOf(rows, [](const ReportRow& r) { return r.rpe_m; });
    average.rpe_deg = meanOf(rows, [](const ReportRow& r) { return r.rpe_deg; });
    return average;
}

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
