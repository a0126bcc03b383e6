#include "evaluation/html_report.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <ostream>
#include <set>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/text.h"

namespace delio::evaluation {
namespace {
const char* const kStyle = R"(
body { margin: 0 auto; max-width: 1200px; padding: 1rem; overflow-wrap: break-word; background: #fff; color: #222;
       font: 16px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.6rem; margin: .2em 0; }
h2 { font-size: 1.25rem; margin: 2em 0 .4em; border-bottom: 1px solid #ddd; }
p { margin: .4em 0; max-width: 75ch; }
.note { color: #666; font-size: .9rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .95rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid #e5e5e5; }
th { vertical-align: bottom; color: #555; }
th.word, td.word { text-align: left; }
td.word { max-width: 18em; min-width: 4em; }
tr.first td { border-top: 2px solid #bbb; }
td.best { font-weight: 700; }
.swatch { display: inline-block; width: .8em; height: .8em; margin-right: .4em; border-radius: 2px; }
.name { white-space: nowrap; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 460px), 1fr)); gap: 1rem; }
figure { margin: 0; }
figure img { width: 100%; border: 1px solid #eee; }
figcaption { font-size: .9rem; color: #444; }
nav a { margin-right: .8em; }
)";

/** An SVG file as an address that holds it: the page needs no other file. */
std::string dataAddress(const std::string& svgFile) {
    std::ifstream in(svgFile, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw Error("cannot read '" + svgFile + "'");
    std::string address = "data:image/svg+xml;charset=utf-8,";
    for (const char c : text.str()) {
        const auto code = static_cast<unsigned char>(c);
        const bool isPlain = code >= 0x20 && code < 0x7F && !std::strchr("%#\"<>&", c);
        address += isPlain ? std::string(1, c) : mrpt::format("%%%02X", code);
    }
    return address;
}

std::string swatch(const std::string& colour) {
    return "<span class=\"swatch\" style=\"background:" + colour + "\"></span>";
}

/** A row of the tables: an estimate on a sequence, or its mean over all of them. */
struct Line {
    std::string sequence, name;
    std::size_t estimate;
    const ReportRow* row;
    const Comparison* comparison;  //!< null: a mean
    bool isCompared;               //!< with the other rows of the sequence
};

/** A column of figures. */
struct Column {
    const char* heading;
    int decimals;
    double (*figure)(const Line&);
    bool lowestIsBest = true;

    /** True if no other row of the sequence has a lower figure, but one has a figure. */
    bool isBest(const std::vector<Line>& lines, const Line& line) const {
        if (!lowestIsBest || !line.isCompared || !std::isfinite(figure(line))) return false;
        bool anyOther = false;
        for (const auto& other : lines) {
            if (&other == &line || other.sequence != line.sequence || !std::isfinite(figure(other)))
                continue;
            if (figure(other) < figure(line)) return false;
            anyOther = true;
        }
        return anyOther;
    }
};

void writeHtmlTable(const std::vector<Line>& lines, const std::vector<Column>& columns,
                    std::ostream& out) {
    out << "<div class=\"scroll\"><table>\n<tr><th class=\"word\">sequence</th>"
           "<th class=\"word\">estimate</th>";
    for (const auto& column : columns) out << "<th>" << column.heading << "</th>";
    out << "</tr>\n";
    std::string sequence;
    for (const auto& line : lines) {
        const bool isFirst = &line == &lines.front() || line.sequence != sequence;
        sequence = line.sequence;
        out << (isFirst ? "<tr class=\"first\">" : "<tr>") << "<td class=\"word\">"
            << (isFirst ? htmlText(sequence) : "") << "</td><td class=\"word"
            << (line.name.size() > 24 ? "" : " name") << "\">" << swatch(colourOf(line.estimate))
            << htmlText(line.name) << "</td>";
        for (const auto& column : columns)
            out << (column.isBest(lines, line) ? "<td class=\"best\">" : "<td>")
                << numberOrDash(column.figure(line), column.decimals) << "</td>";
        out << "</tr>\n";
    }
    out << "</table></div>\n";
}

void writePlots(const std::vector<Chart>& charts, const std::string& folder, std::ostream& out) {
    out << "<div class=\"plots\">\n";
    for (const auto& chart : charts)
        out << "<figure><img alt=\"" << htmlText(chart.caption()) << "\" src=\""
            << dataAddress(folder + "/" + chart.name() + ".svg") << "\"><figcaption>"
            << htmlText(chart.caption()) << ".</figcaption></figure>\n";
    out << "</div>\n";
}

/** Sequence by sequence, estimates side by side, then the means. */
std::vector<Line> linesOf(const std::vector<Section>& sections,
                          const std::vector<Group>& byEstimate,
                          const std::vector<ReportRow>& averages, bool meansAreCompared) {
    std::vector<Line> lines;
    for (const auto& [sequence, charts, maps] : sections)
        for (std::size_t i = 0; i < sequence.members.size(); ++i) {
            const auto* member = sequence.members[i];
            lines.push_back({sequence.name, member->row.name, sequence.estimates[i], &member->row,
                             member, true});
        }
    for (const auto& average : averages)
        for (const auto& group : byEstimate)
            if (group.name == average.name)
                lines.push_back({"mean", average.name, group.estimates.front(), &average, nullptr,
                                 meansAreCompared});
    return lines;
}

/** True if the estimates have been scored on different sequences. */
bool setsDiffer(const std::vector<Group>& byEstimate) {
    std::set<std::set<std::string>> sets;
    for (const auto& group : byEstimate) {
        std::set<std::string> sequences;
        for (const auto* member : group.members) sequences.insert(member->row.sequence);
        sets.insert(sequences);
    }
    return sets.size() > 1;
}

void writeHead(const std::vector<Group>& byEstimate, const ReportNotes& notes, std::ostream& out) {
    out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<title>Trajectory evaluation</title>\n<style>"
        << kStyle << "</style>\n</head>\n<body>\n<h1>Trajectory evaluation</h1>\n<p>";
    for (const auto& group : byEstimate)
        out << swatch(colourOf(group.estimates.front())) << htmlText(group.name) << "&emsp;";
    out << swatch(kTruthColour) << "ground truth</p>\n<p class=\"note\">" << htmlText(notes.program)
        << ". Segments of " << htmlText(notes.lengths)
        << " m from every tenth pose on. Bold: best of each sequence.</p>\n";
}

void writeKittiErrors(const std::vector<Line>& lines, bool unlike, std::ostream& out) {
    out << "<h2>KITTI's metric</h2>\n<p class=\"note\">Mean error over segments, relative to their "
           "length. The mean over sequences is unweighted.</p>\n";
    if (unlike)
        out << "<p><b>The estimates cover different sequences: their means and their curves over "
               "all sequences cannot be compared.</b></p>\n";
    writeHtmlTable(
        lines,
        {{"translation [%]", 3, [](const Line& l) { return l.row->kitti.t_percent; }},
         {"rotation [deg/100 m]", 3, [](const Line& l) { return l.row->kitti.r_deg_per_100m; }},
         {"length [m]", 1, [](const Line& l) { return l.row->length_m; }, false},
         {"segments", 0, [](const Line& l) { return double(l.row->kitti.segments); }, false}},
        out);
    const bool anySegments = std::any_of(
        lines.begin(), lines.end(), [](const Line& line) { return line.row->kitti.segments > 0; });
    if (!anySegments)
        out << "<p>The drive is too short for segments of these lengths; give shorter ones with "
               "--lengths.</p>\n";
}

void writePoseErrors(const std::vector<Line>& lines, std::size_t delta, std::ostream& out) {
    out << "<h2>Absolute and relative pose error</h2>\n<p class=\"note\">APE: RMSE of the "
           "positions after rigid alignment. RPE: RMSE of the relative motion over "
        << delta << (delta == 1 ? " pose" : " poses") << ".</p>\n";
    writeHtmlTable(lines,
                   {{"APE [m]", 3, [](const Line& l) { return l.row->ape_m; }},
                    {"RPE [m]", 4, [](const Line& l) { return l.row->rpe_m; }},
                    {"RPE [deg]", 4, [](const Line& l) { return l.row->rpe_deg; }}},
                   out);
}

/** The spread of the errors from scan to scan, and how many scans were predicted. */
void writeSteps(std::vector<Line> lines, std::ostream& out) {
    out << "<h2>Error per scan</h2>\n";
    const auto isMean = [](const Line& line) { return !line.comparison; };
    lines.erase(std::remove_if(lines.begin(), lines.end(), isMean), lines.end());
    const auto predicted = [](const Line& line) {
        const auto& flags = line.comparison->predicted;
        return flags.empty() ? NAN : double(std::count(flags.begin(), flags.end(), true));
    };
    writeHtmlTable(
        lines,
        {{"transl. median [m]", 4,
          [](const Line& l) { return l.comparison->perScan.translation_m.median; }},
         {"p95 [m]", 4, [](const Line& l) { return l.comparison->perScan.translation_m.p95; }},
         {"max [m]", 3, [](const Line& l) { return l.comparison->perScan.translation_m.max; }},
         {"rot. median [deg]", 4,
          [](const Line& l) { return l.comparison->perScan.rotation_deg.median; }},
         {"p95 [deg]", 4, [](const Line& l) { return l.comparison->perScan.rotation_deg.p95; }},
         {"max [deg]", 3, [](const Line& l) { return l.comparison->perScan.rotation_deg.max; }},
         {"predicted scans", 0, predicted}},
        out);
}

void writeSequences(const std::vector<Section>& sections, const std::string& plotFolder,
                    std::ostream& out) {
    if (sections.size() > 1) {
        out << "<h2>Sequences</h2>\n<nav>";
        for (std::size_t i = 0; i < sections.size(); ++i)
            out << "<a href=\"#s" << i << "\">" << htmlText(sections[i].sequence.name) << "</a>";
        out << "</nav>\n";
    }
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const auto& section = sections[i];
        out << "<h2 id=\"s" << i << "\">Sequence " << htmlText(section.sequence.name) << "</h2>\n";
        for (std::size_t k = 0; k < section.maps.size(); ++k)
            if (!section.maps[k].empty())
                out << "<p><a href=\"" << section.maps[k] << "\">Map of "
                    << htmlText(section.sequence.members[k]->row.name) << "</a></p>\n";
        writePlots(section.charts, plotFolder, out);
    }
}
}  // namespace

std::string numberOrDash(double value, int decimals) {
    return std::isfinite(value) ? fixed(value, decimals) : "-";
}

void writeHtml(const std::vector<Group>& byEstimate, const std::vector<Section>& sections,
               const std::vector<Chart>& overview, const std::vector<ReportRow>& averages,
               const ReportNotes& notes, const std::string& plotFolder, std::ostream& out) {
    const bool unlike = setsDiffer(byEstimate);
    const auto lines = linesOf(sections, byEstimate, averages, !unlike);
    writeHead(byEstimate, notes, out);
    writeKittiErrors(lines, unlike, out);
    writePlots(overview, plotFolder, out);
    writePoseErrors(lines, notes.delta, out);
    writeSteps(lines, out);
    writeSequences(sections, plotFolder, out);
    out << "</body>\n</html>\n";
}
}  // namespace delio::evaluation
