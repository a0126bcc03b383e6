#include "evaluation/html_report.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <ostream>
#include <set>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/core/printable.h"
#include "evaluation/charts.h"

namespace delio::evaluation {
using mrpt::format;

namespace {
const char* const kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1200px; padding: 1rem; overflow-wrap: break-word; background: #fff; color: #222;
       font: 16px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.6rem; margin: .2em 0; }
h2 { font-size: 1.25rem; margin: 2em 0 .4em; border-bottom: 1px solid #ddd; }
h3 { font-size: 1.05rem; margin: 1.4em 0 .4em; }
p { margin: .4em 0; max-width: 75ch; }
.note { color: #666; font-size: .9rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .95rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid #e5e5e5; }
th { vertical-align: bottom; color: #555; font-weight: 600; }
th.word, td.word { text-align: left; }
td.word { max-width: 18em; min-width: 4em; overflow-wrap: break-word; }
tr.first td { border-top: 2px solid #bbb; }
td.best { font-weight: 700; }
.swatch { display: inline-block; width: .8em; height: .8em; margin-right: .4em;
          border-radius: 2px; }
.name { white-space: nowrap; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 460px), 1fr));
         gap: 1rem; }
figure { margin: 0; }
figure img { width: 100%; height: auto; border: 1px solid #eee; }
figcaption { font-size: .9rem; color: #444; }
nav a { margin-right: .8em; }
@media (max-width: 640px) {
  body { padding: .5rem; font-size: 15px; }
  table { font-size: .8rem; }
  th, td { padding: .25em .4em; }
  td.word { max-width: 10em; }
}
)";

const char* const kMean = "mean";  // heading of the rows of averages

/** An SVG file as an address that holds it: the page needs no other file. */
std::string dataAddress(const std::string& svgFile) {
    std::ifstream in(svgFile, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw Error("cannot read '" + svgFile + "'");
    std::string address = "data:image/svg+xml;charset=utf-8,";
    for (const char c : text.str()) {
        const auto code = static_cast<unsigned char>(c);
        if (code <= 0x20 && c != ' ')
            address += "%0A";  // a line end or a tab: white space, all of it
        else if (code >= 0x7F || std::string("%#\"<>&").find(c) != std::string::npos)
            address += format("%%%02X", code);
        else
            address += c;
    }
    return address;
}

std::string number(double value, int decimals) {
    return std::isfinite(value) ? fixed(value, decimals) : "-";
}

/** A column of figures of which the lowest is the best. */
struct Column {
    std::string heading;
    int decimals;
    std::vector<double> values;  // a row each
    bool lowestIsBest = true;
};

class Page {
 public:
    /** `groupNotCompared`: name of rows that are not compared with each other. */
    Page(const std::string& plotFolder, std::string groupNotCompared, std::ostream& out)
        : plots_(plotFolder), groupNotCompared_(std::move(groupNotCompared)), out_(out) {}

    /** `groups`: rows of one group are compared with each other; group and estimate by row. */
    void table(const std::vector<std::string>& groups, const std::vector<std::string>& names,
               const std::vector<std::size_t>& estimates,
               const std::vector<Column>& columns) const {
        out_ << "<div class=\"scroll\"><table>\n<tr><th class=\"word\">sequence</th>"
                "<th class=\"word\">estimate</th>";
        for (const auto& column : columns) out_ << "<th>" << htmlText(column.heading) << "</th>";
        out_ << "</tr>\n";
        for (std::size_t i = 0; i < groups.size(); ++i) {
            const bool first = i == 0 || groups[i] != groups[i - 1];
            out_ << (first ? "<tr class=\"first\">" : "<tr>") << "<td class=\"word\">"
                 << (first ? htmlText(groups[i]) : "") << "</td><td class=\"word\">"
                 << estimate(names[i], estimates[i]) << "</td>";
            for (const auto& column : columns)
                out_ << (isBest(groups, column, i) ? "<td class=\"best\">" : "<td>")
                     << number(column.values[i], column.decimals) << "</td>";
            out_ << "</tr>\n";
        }
        out_ << "</table></div>\n";
    }

    void plots(const std::vector<Chart>& charts) const {
        out_ << "<div class=\"plots\">\n";
        for (const auto& chart : charts)
            out_ << "<figure><img alt=\"" << htmlText(chart.caption()) << "\" src=\""
                 << dataAddress(plots_ + "/" + chart.name() + ".svg") << "\"><figcaption>"
                 << htmlText(chart.caption()) << ".</figcaption></figure>\n";
        out_ << "</div>\n";
    }

    /** Its colour and its name: on one line where that is short. */
    static std::string estimate(const std::string& name, std::size_t index) {
        const std::string text = swatch(index) + htmlText(name);
        return name.size() > 24 ? text : "<span class=\"name\">" + text + "</span>";
    }

    static std::string swatch(std::size_t estimate) {
        return "<span class=\"swatch\" style=\"background:" + colourOf(estimate) + "\"></span>";
    }

 private:
    bool isBest(const std::vector<std::string>& groups, const Column& column,
                std::size_t row) const {
        if (!column.lowestIsBest || groups[row] == groupNotCompared_ ||
            !std::isfinite(column.values[row]))
            return false;
        bool compared = false;
        for (std::size_t i = 0; i < groups.size(); ++i) {
            if (i == row || groups[i] != groups[row] || !std::isfinite(column.values[i])) continue;
            compared = true;
            if (column.values[i] < column.values[row]) return false;
        }
        return compared;
    }

    std::string plots_, groupNotCompared_;
    std::ostream& out_;
};

/** The rows of the tables, sequence by sequence, estimates side by side. */
struct Lines {
    std::vector<std::string> groups, names;
    std::vector<std::size_t> estimates;
    std::vector<ReportRow> rows;
};

Lines linesOf(const std::vector<Section>& sections, const std::vector<Group>& byEstimate,
              const std::vector<ReportRow>& averages) {
    Lines lines;
    const auto add = [&](const std::string& group, const ReportRow& row, std::size_t estimate) {
        lines.groups.push_back(group);
        lines.names.push_back(row.name);
        lines.estimates.push_back(estimate);
        lines.rows.push_back(row);
    };
    for (const auto& section : sections)
        for (std::size_t i = 0; i < section.sequence.members.size(); ++i)
            add(section.sequence.name, section.sequence.members[i]->row,
                section.sequence.estimates[i]);
    for (const auto& average : averages)
        for (const auto& group : byEstimate)
            if (group.name == average.name) add(kMean, average, group.estimates.front());
    return lines;
}

template <typename Figure>
Column column(const std::string& heading, int decimals, const Lines& lines, const Figure& figure,
              bool lowestIsBest = true) {
    Column result{heading, decimals, {}, lowestIsBest};
    for (const auto& row : lines.rows) result.values.push_back(figure(row));
    return result;
}

/** Errors from scan to scan: their spread, and how many scans were predicted. */
void writeSteps(const Page& page, const std::vector<Section>& sections) {
    std::vector<std::string> groups, names;
    std::vector<std::size_t> estimates;
    std::vector<Column> columns = {
        {"transl. median [m]", 4, {}}, {"p95 [m]", 4, {}},   {"max [m]", 3, {}},
        {"rot. median [deg]", 4, {}},  {"p95 [deg]", 4, {}}, {"max [deg]", 3, {}},
        {"predicted scans", 0, {}}};
    for (const auto& section : sections)
        for (std::size_t i = 0; i < section.sequence.members.size(); ++i) {
            const auto& member = *section.sequence.members[i];
            const auto& steps = member.perScan;
            groups.push_back(section.sequence.name);
            names.push_back(member.row.name);
            estimates.push_back(section.sequence.estimates[i]);
            const auto& flags = member.predicted;
            const double predicted =
                flags.empty() ? NAN : double(std::count(flags.begin(), flags.end(), true));
            const double values[] = {steps.translation_m.median,
                                     steps.translation_m.p95,
                                     steps.translation_m.max,
                                     steps.rotation_deg.median,
                                     steps.rotation_deg.p95,
                                     steps.rotation_deg.max,
                                     predicted};
            for (std::size_t k = 0; k < columns.size(); ++k) columns[k].values.push_back(values[k]);
        }
    page.table(groups, names, estimates, columns);
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
        out << Page::swatch(group.estimates.front()) << htmlText(group.name) << "&emsp;";
    out << "<span class=\"swatch\" style=\"background:" << kTruthColour
        << "\"></span>ground truth</p>\n<p class=\"note\">" << htmlText(notes.program)
        << ". Segments of " << htmlText(notes.lengths)
        << " m from every tenth pose on. Bold: best of each sequence.</p>\n";
}

void writeKittiErrors(const Page& page, const Lines& lines, bool unlike, std::ostream& out) {
    out << "<h2>KITTI's metric</h2>\n<p class=\"note\">Mean error over segments, relative to their "
           "length. The mean over sequences is unweighted.</p>\n";
    if (unlike)
        out << "<p><b>The estimates cover different sequences: their means and their curves over "
               "all sequences cannot be compared.</b></p>\n";
    page.table(
        lines.groups, lines.names, lines.estimates,
        {column("translation [%]", 3, lines, [](const auto& r) { return r.kitti.t_percent; }),
         column("rotation [deg/100 m]", 3, lines,
                [](const auto& r) { return r.kitti.r_deg_per_100m; }),
         column(
             "length [m]", 1, lines, [](const auto& r) { return r.length_m; }, false),
         column(
             "segments", 0, lines, [](const auto& r) { return double(r.kitti.segments); }, false)});
    const bool anySegments = std::any_of(lines.rows.begin(), lines.rows.end(),
                                         [](const auto& r) { return r.kitti.segments > 0; });
    if (!anySegments)
        out << "<p>The drive is too short for segments of these lengths; give shorter ones with "
               "--lengths.</p>\n";
}

void writePoseErrors(const Page& page, const Lines& lines, std::size_t delta, std::ostream& out) {
    out << "<h2>Absolute and relative pose error</h2>\n<p class=\"note\">APE: RMSE of the "
           "positions after rigid alignment. RPE: RMSE of the relative motion over "
        << delta << (delta == 1 ? " pose" : " poses") << ".</p>\n";
    page.table(lines.groups, lines.names, lines.estimates,
               {column("APE [m]", 3, lines, [](const auto& r) { return r.ape_m; }),
                column("RPE [m]", 4, lines, [](const auto& r) { return r.rpe_m; }),
                column("RPE [deg]", 4, lines, [](const auto& r) { return r.rpe_deg; })});
}

void writeSequences(const Page& page, const std::vector<Section>& sections, std::ostream& out) {
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
        page.plots(section.charts);
    }
}
}  // namespace

void writeHtml(const std::vector<Group>& byEstimate, const std::vector<Section>& sections,
               const std::vector<Chart>& overview, const std::vector<ReportRow>& averages,
               const ReportNotes& notes, const std::string& plotFolder, std::ostream& out) {
    const bool unlike = setsDiffer(byEstimate);
    const Page page(plotFolder, unlike ? kMean : "", out);
    const Lines lines = linesOf(sections, byEstimate, averages);
    writeHead(byEstimate, notes, out);
    writeKittiErrors(page, lines, unlike, out);
    if (!overview.empty()) {
        out << "<h3>Errors over segment length and speed</h3>\n";
        page.plots(overview);
    }
    writePoseErrors(page, lines, notes.delta, out);
    out << "<h2>Error per scan</h2>\n";
    writeSteps(page, sections);
    writeSequences(page, sections, out);
    out << "</body>\n</html>\n";
}
}  // namespace delio::evaluation
