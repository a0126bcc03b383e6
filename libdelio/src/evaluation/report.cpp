#include "delio/evaluation/report.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <set>
#include <string>

#include "delio/core/error.h"
#include "delio/files/output.h"
#include "evaluation/charts.h"
#include "evaluation/html_report.h"

namespace delio::evaluation {
namespace fs = std::filesystem;

namespace {
using Cells = std::vector<std::string>;

Cells cellsOf(const ReportRow& row, int decimals) {
    return {row.name,
            row.sequence,
            numberOrDash(row.length_m, decimals),
            std::to_string(row.kitti.segments),
            numberOrDash(row.kitti.t_percent, decimals),
            numberOrDash(row.kitti.r_deg_per_100m, decimals),
            numberOrDash(row.ape_m, decimals),
            numberOrDash(row.rpe_m, decimals),
            numberOrDash(row.rpe_deg, decimals)};
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

// All that a report consists of; the page marks it as whole.
const std::vector<std::string> kNames = {"report.html", "metrics.tsv", "lengths.tsv", "plots"};

Group& groupCalled(const std::string& name, std::vector<Group>& groups) {
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const Group& group) { return group.name == name; });
    if (found != groups.end()) return *found;
    groups.push_back({name, {}, {}});
    return groups.back();
}

/** Beginning of the names of a sequence's files: the sequence's own name where that is safe. */
std::string prefixOf(const std::string& sequence, std::set<std::string>& taken) {
    std::string prefix;
    for (const char c : sequence.substr(0, 60))
        prefix += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
    std::string unique = prefix;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = prefix + "-" + std::to_string(i);
    return unique + "_";
}

/** A file's address in a page of `folder`: relative, so that both can be moved or sent together. */
std::string addressOf(const fs::path& file, const fs::path& folder) {
    std::string address;
    for (const char c : fs::proximate(file, folder).generic_string()) {
        const auto code = static_cast<unsigned char>(c);
        const bool isPlain = code < 0x80 && (std::isalnum(code) || std::strchr("-._~/", c));
        address += isPlain ? std::string(1, c) : mrpt::format("%%%02X", code);
    }
    return address;
}

void dropEmpty(std::vector<Chart>& charts) {
    charts.erase(std::remove_if(charts.begin(), charts.end(),
                                [](const Chart& chart) { return chart.empty(); }),
                 charts.end());
}
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
            writeLine(
                {row.name, row.sequence, numberOrDash(errors.length_m, kTsvDecimals),
                 std::to_string(errors.segments), numberOrDash(errors.t_percent, kTsvDecimals),
                 numberOrDash(errors.r_deg_per_100m, kTsvDecimals)},
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

void writeReportFolder(const std::vector<Comparison>& comparisons,
                       const std::vector<ReportRow>& rows, const ReportNotes& notes,
                       const std::string& folder) {
    std::vector<Group> byEstimate, bySequence;
    for (const auto& comparison : comparisons) {
        auto& estimate = groupCalled(comparison.row.name, byEstimate);
        estimate.members.push_back(&comparison);
        const auto index = static_cast<std::size_t>(&estimate - byEstimate.data());
        estimate.estimates.push_back(index);
        auto& sequence = groupCalled(comparison.row.sequence, bySequence);
        sequence.members.push_back(&comparison);
        sequence.estimates.push_back(index);
    }
    std::sort(bySequence.begin(), bySequence.end(),
              [](const Group& a, const Group& b) { return a.name < b.name; });

    std::set<std::string> taken = {"all"};
    std::vector<Section> sections;
    std::vector<Chart> overview = overviewCharts(byEstimate), all;
    for (const auto& sequence : bySequence) {
        sections.push_back(
            {sequence, sequenceCharts(sequence, prefixOf(sequence.name, taken)), {}});
        for (const auto* member : sequence.members)
            sections.back().maps.push_back(
                member->mapPage.empty() ? "" : addressOf(member->mapPage, folder));
        auto& charts = sections.back().charts;
        dropEmpty(charts);
        all.insert(all.end(), charts.begin(), charts.end());
    }
    dropEmpty(overview);
    all.insert(all.end(), overview.begin(), overview.end());

    std::vector<ReportRow> averages;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(averages),
                 [](const ReportRow& row) { return row.sequence == "avg"; });

    const io::TargetFolder target(folder);
    io::PartialFolder partial(folder, folder);
    const auto path = [&](const char* name) { return (partial.path() / name).string(); };
    try {
        std::error_code fault;
        if (!fs::create_directory(path("plots"), fault))
            throw Error("cannot create the folder '" + path("plots") + "': " + fault.message());
        drawCharts(all, path("plots"));
        io::replaceTextFile(path("metrics.tsv"),
                            [&](std::ostream& out) { writeMetricsTsv(rows, out); });
        io::replaceTextFile(path("lengths.tsv"),
                            [&](std::ostream& out) { writeLengthsTsv(rows, out); });
        io::replaceTextFile(path("report.html"), [&](std::ostream& out) {
            writeHtml(byEstimate, sections, overview, averages, notes, path("plots"), out);
        });
    } catch (const Error& e) {
        throw Error(partial.asInPlace(e.what()));
    }
    partial.putInPlace(kNames);
}

std::vector<std::string> reportFiles(const std::string& folder) {
    std::vector<std::string> files;
    files.reserve(std::size(kNames));
    for (const auto& name : kNames) files.push_back((fs::path(folder) / name).string());
    return files;
}
}  // namespace delio::evaluation
