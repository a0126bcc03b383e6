#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/core/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/evaluation/metrics.h"
#include "delio/evaluation/report.h"
#include "delio/formats/trajectory.h"
#include "delio/version.h"
#include "eval_inputs.h"
#include "overlap.h"

namespace {
namespace fs = std::filesystem;
using namespace delio;
using evaluation::ReportRow;

/** "100,200,300": rising positive numbers; nothing where the text is anything else. */
std::vector<double> lengthsOf(const std::string& text) {
    std::vector<double> lengths;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const auto length = numberIn<double>(text.substr(begin, end - begin));
        const double least = lengths.empty() ? 0 : lengths.back();
        if (!length || !std::isfinite(*length) || *length <= least) return {};
        lengths.push_back(*length);
        begin = end + 1;
    }
    return lengths;
}

struct LengthsConstraint : TCLAP::Constraint<std::string> {
    std::string description() const override {
        return "increasing lengths in metres, such as 100,200,400";
    }
    std::string shortID() const override { return "100,200,..."; }
    bool check(const std::string& text) const override { return !lengthsOf(text).empty(); }
};

struct DeltaConstraint : TCLAP::Constraint<int> {
    std::string description() const override { return "a number of poses, at least 1"; }
    std::string shortID() const override { return "N"; }
    bool check(const int& delta) const override { return delta >= 1; }
};

void refuseReport(const std::string& folder, bool force) {
    if (folder.empty() || !fs::exists(folder)) return;
    if (!fs::is_directory(folder))
        throw Error("'" + folder + "' is a file; give a folder for the report");
    if (!fs::is_empty(folder)) cli::refuseExisting(folder, force);
}

/** The rows of all results: of folders, the mean of each estimate's sequences after them. */
std::vector<ReportRow> rowsOf(const std::vector<evaluation::Comparison>& comparisons,
                              bool withAverages) {
    std::vector<ReportRow> rows, own;
    std::set<std::set<std::string>> sets;
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
        own.push_back(comparisons[i].row);
        const bool last =
            i + 1 == comparisons.size() || comparisons[i + 1].row.name != comparisons[i].row.name;
        if (!last) continue;
        rows.insert(rows.end(), own.begin(), own.end());
        if (withAverages) rows.push_back(evaluation::averageOf(own));
        std::set<std::string> sequences;
        for (const auto& row : own) sequences.insert(row.sequence);
        sets.insert(sequences);
        own.clear();
    }
    if (withAverages && sets.size() > 1)
        cli::warn("the estimates cover different sequences; their averages cannot be compared");
    return rows;
}

/** Command-line arguments. */
struct CommandLine {
    TCLAP::CmdLine cmd{"evaluates trajectories against a reference", ' ', kVersion};
    TCLAP::ValueArg<std::string> reference{
        "r",  "ref", "Reference poses: a file (KITTI or TUM format) or a folder of NN.txt files",
        true, "",    "REF.txt|DIR",
        cmd};
    TCLAP::MultiArg<std::string> estimates{"e",
                                           "est",
                                           "Estimated poses: a file or a result folder of "
                                           "delio-slam; if --ref is a folder, a folder of either",
                                           true,
                                           "[NAME=]EST.txt|DIR",
                                           cmd};
    TCLAP::ValueArg<std::string> calibration{
        "c",
        "calib",
        "Calibration whose Tr transforms estimates from the LiDAR frame to cam0; for folders the "
        "same Tr is used for all sequences",
        false,
        "",
        "calib.txt",
        cmd};
    LengthsConstraint lengthsConstraint;
    TCLAP::ValueArg<std::string> lengths{"l",
                                         "lengths",
                                         "Lengths of KITTI's segments, metres",
                                         false,
                                         textOf(evaluation::kittiLengths_m()),
                                         &lengthsConstraint,
                                         cmd};
    DeltaConstraint deltaConstraint;
    TCLAP::ValueArg<int> delta{"d",   "delta", "Number of poses between which RPE is computed",
                               false, 1,       &deltaConstraint,
                               cmd};
    std::vector<std::string> formats{"table", "tsv"};
    TCLAP::ValuesConstraint<std::string> formatsConstraint{formats};
    TCLAP::ValueArg<std::string> format{
        "f", "format", "Output format", false, "table", &formatsConstraint, cmd};
    TCLAP::ValueArg<std::string> output{
        "o", "output", "Folder for the HTML report (needs gnuplot)", false, "", "REPORT_DIR", cmd};
    TCLAP::SwitchArg sameFrame{"", "same-frame",
                               "Also report pose differences without alignment; for a drive "
                               "localised in a stored map and a reference in the same frame",
                               cmd};
    TCLAP::SwitchArg force{"", "force", "Write into a non-empty report folder", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "Print which files are compared", cmd};
};

EvalSettings settingsOf(CommandLine& line) {
    EvalSettings settings;
    settings.verbose = line.verbose.getValue();
    settings.comparison.lengths_m = lengthsOf(line.lengths.getValue());
    settings.comparison.delta = static_cast<std::size_t>(line.delta.getValue());
    if (line.calibration.isSet()) {
        const auto read = io::readCalibration(line.calibration.getValue());
        if (!read.hasTr)
            throw Error("'" + line.calibration.getValue() +
                        "' has no Tr (the transformation from the LiDAR frame to cam0)");
        settings.Tr = read.Tr;
    }
    return settings;
}

/** A line for each estimate. */
void writeDistances(const std::vector<evaluation::Comparison>& comparisons, std::ostream& out) {
    for (const auto& found : comparisons) {
        const auto error = evaluation::poseError(found.reference, found.estimate);
        const auto& row = found.row;
        out << row.name << (row.sequence.empty() ? "" : " ") << row.sequence
            << mrpt::format(
                   ": unaligned difference to the reference: median %.4f m, %.4f deg; p95 %.4f m, "
                   "%.4f deg; worst %.4f m, %.4f deg; %zu poses\n",
                   error.translation_m.median, error.rotation_deg.median, error.translation_m.p95,
                   error.rotation_deg.p95, error.translation_m.max, error.rotation_deg.max,
                   found.reference.size());
    }
}

std::vector<std::string> inputsOf(CommandLine& line) {
    std::vector<std::string> inputs = {line.reference.getValue(), line.calibration.getValue()};
    for (const auto& text : line.estimates.getValue()) inputs.push_back(estimateOf(text).path);
    return inputs;
}

int evaluate(CommandLine& line) {
    std::vector<Estimate> estimates;
    for (const auto& text : line.estimates.getValue()) estimates.push_back(estimateOf(text));
    if (const std::string fault = faultOfNames(estimates); !fault.empty()) {
        cli::inform(fault + "; see --help");
        return cli::kExitBadCommandLine;
    }
    const auto& reference = line.reference.getValue();
    const auto& output = line.output.getValue();
    refuseReport(output, line.force.getValue());
    if (!output.empty()) cli::refuseOverlap(inputsOf(line), evaluation::reportFiles(output));

    const auto settings = settingsOf(line);
    std::vector<evaluation::Comparison> comparisons;
    for (const auto& estimate : estimates)
        for (auto& comparison : compareSequences(reference, estimate, settings))
            comparisons.push_back(std::move(comparison));
    const auto rows = rowsOf(comparisons, fs::is_directory(reference));
    if (!output.empty())
        evaluation::writeReportFolder(
            comparisons, rows,
            {std::string("delio-eval ") + kVersion, textOf(settings.comparison.lengths_m),
             settings.comparison.delta},
            output);
    if (line.format.getValue() == "tsv")
        evaluation::writeMetricsTsv(rows, std::cout);
    else
        evaluation::writeTable(rows, std::cout);
    if (line.sameFrame.isSet()) writeDistances(comparisons, std::cout);
    if (!std::cout.flush()) throw Error("cannot write the results to stdout");
    return cli::kExitSuccess;
}

cli::HelpText help() {
    cli::HelpText help;
    help.about =
        "Computes KITTI's translation error (percent) and rotation error (deg/100 m), averaged "
        "over segments; APE (RMSE in metres after rigid alignment without scale); and RPE (RMSE "
        "over --delta poses, metres and degrees). '-' means that the drive is too short. TUM poses "
        "are matched by time (within 0.02 s), all others by row. With two folders, every NN.txt "
        "that is in both is one sequence. The row 'avg' is the unweighted mean over sequences, as "
        "in papers on KITTI; lengths and segments are summed.";
    help.writes = {{"standard output", "errors, one row per estimate and sequence"},
                   {"report.html", "with -o: the report, one page including its plots"},
                   {"plots/", "with -o: plots as SVG and PNG, with data and gnuplot scripts"},
                   {"metrics.tsv, lengths.tsv", "with -o: errors, and errors by segment length"}};
    help.examples = {{{"delio-eval -r dataset/poses/07.txt -e 07-results -o 07-report",
                       "Evaluate a KITTI drive and write a report"},
                      {"delio-eval -r dataset/poses -e ours=results -e theirs=others -f tsv",
                       "Compare two estimates on several sequences"}}};
    help.interrupted = "existing files are unchanged";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    CommandLine line;
    return cli::run(line.cmd, help(), argc, argv, line.verbose, [&] { return evaluate(line); });
}
