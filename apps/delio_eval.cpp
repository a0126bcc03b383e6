#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>

#include "cli.h"
#include "delio/error.h"
#include "delio/evaluation/association.h"
#include "delio/evaluation/frame_check.h"
#include "delio/evaluation/report.h"
#include "delio/io/output_file.h"
#include "delio/io/trajectory.h"
#include "delio/version.h"

namespace {
namespace fs = std::filesystem;
using namespace delio;
using evaluation::ReportRow;

struct Estimate {
    std::string name;
    std::string path;
};

struct Settings {
    std::optional<mrpt::poses::CPose3D> Tr;  // set: estimates are brought from LiDAR to cam0
    std::vector<double> lengths_m;
    std::size_t delta = 1;
    bool verbose = false;
};

/** "100,200,300": rising positive numbers; nothing where the text is anything else. */
std::vector<double> lengthsOf(const std::string& text) {
    std::vector<double> lengths;
    const char* p = text.data();
    const char* const end = p + text.size();
    while (true) {
        double length = 0;
        const auto result = std::from_chars(p, end, length);
        const double least = lengths.empty() ? 0 : lengths.back();
        if (result.ec != std::errc{} || !std::isfinite(length) || length <= least) return {};
        lengths.push_back(length);
        if (result.ptr == end) return lengths;
        if (*result.ptr != ',') return {};
        p = result.ptr + 1;
    }
}

std::string textOf(const std::vector<double>& lengths) {
    std::string text;
    for (const double length : lengths)
        text += (text.empty() ? "" : ",") + mrpt::format("%g", length);
    return text;
}

struct LengthsConstraint : TCLAP::Constraint<std::string> {
    std::string description() const override { return "rising lengths in metres, as 100,200,400"; }
    std::string shortID() const override { return "100,200,..."; }
    bool check(const std::string& text) const override { return !lengthsOf(text).empty(); }
};

struct DeltaConstraint : TCLAP::Constraint<int> {
    std::string description() const override { return "a count of poses, 1 or more"; }
    std::string shortID() const override { return "N"; }
    bool check(const int& delta) const override { return delta >= 1; }
};

/** `[NAME=]PATH`, named after the file or folder where no name is given. */
Estimate estimateOf(const std::string& text) {
    const auto equals = text.find('=');
    if (equals != std::string::npos && !fs::exists(text))
        return {text.substr(0, equals), text.substr(equals + 1)};
    const fs::path path = fs::path(text).lexically_normal();
    const fs::path last = path.has_filename() ? path : path.parent_path();
    return {last.stem().string(), text};
}

/** What is wrong with the names of the estimates; empty if nothing. */
std::string faultOfNames(const std::vector<Estimate>& estimates) {
    std::set<std::string> names;
    for (const auto& estimate : estimates) {
        if (estimate.name.empty() || estimate.path.empty() ||
            estimate.name.find_first_of("\t\n\r") != std::string::npos)
            return "--est wants NAME=PATH with a NAME of one line, without tabs";
        if (!names.insert(estimate.name).second)
            return "two estimates are called '" + estimate.name +
                   "'; tell them apart with --est NAME=PATH";
    }
    return "";
}

/** The pose file of an estimate: a folder that delio-slam has written stands for the trajectory in
 *  it that is, or after --calib will be, in the frame of cam0. */
std::string poseFile(const std::string& path, bool calibrationGiven) {
    if (!fs::is_directory(path)) return path;
    for (const char* name : {"trajectory_kitti_cam0.txt", "trajectory_kitti.txt"}) {
        const fs::path file = fs::path(path) / name;
        const bool inCam0 = std::string(name) == "trajectory_kitti_cam0.txt";
        if (fs::exists(file) && !(inCam0 && calibrationGiven)) return file.string();
    }
    throw Error("'" + path +
                "' is a folder without a trajectory_kitti.txt; give --ref a folder too to score "
                "every NN.txt in it, or name a pose file");
}

/** Names of the pose files that lie in both folders. */
std::vector<std::string> sharedFiles(const fs::path& reference, const fs::path& estimate) {
    if (!fs::is_directory(estimate))
        throw Error("'" + estimate.string() + "' is no folder, but the reference is one ('" +
                    reference.string() + "'); give two folders or two files");
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(reference))
        if (entry.path().extension() == ".txt" && fs::exists(estimate / entry.path().filename()))
            names.push_back(entry.path().filename().string());
    if (names.empty())
        throw Error("'" + estimate.string() + "' has no pose file (NN.txt) that is in '" +
                    reference.string() + "' too");
    std::sort(names.begin(), names.end());
    return names;
}

std::string faultOfFrames(evaluation::FrameMismatch mismatch, bool calibrationGiven) {
    switch (mismatch) {
        case evaluation::FrameMismatch::none:
            return "";
        case evaluation::FrameMismatch::lidarAgainstCamera:
            return "the estimate looks like it is in the LiDAR frame (x forward), the reference in "
                   "the camera frame (z forward); give --calib calib.txt to bring the estimate to "
                   "cam0";
        case evaluation::FrameMismatch::cameraAgainstLidar:
            break;
    }
    return calibrationGiven
               ? "the estimate looks like it is in cam0's frame already, or the reference in the "
                 "LiDAR frame; leave --calib out"
               : "the estimate looks like it is in the camera frame (z forward), the reference in "
                 "the LiDAR frame (x forward); give both in the same frame";
}

/** Scores one pose file against another. */
ReportRow rowOf(const std::string& name, const std::string& referenceFile,
                const std::string& estimateFile, const Settings& settings) {
    const auto reference = io::readTrajectory(referenceFile);
    auto estimate = io::readTrajectory(estimateFile);
    if (settings.Tr) estimate = io::lidarToCam0(estimate, *settings.Tr);

    const std::string pair = "'" + estimateFile + "' against '" + referenceFile + "': ";
    evaluation::Association matched;
    try {
        matched = evaluation::associate(reference, estimate);
    } catch (const Error& e) {
        throw Error(pair + e.what());
    }
    if (matched.unmatchedReference + matched.unmatchedEstimate > 0)
        cli::warn(pair + std::to_string(matched.estimate.size()) + " poses match in time; " +
                  std::to_string(matched.unmatchedEstimate) + " of the estimate and " +
                  std::to_string(matched.unmatchedReference) +
                  " of the reference have no partner and are left out");
    else if (settings.verbose)
        cli::inform(pair + std::to_string(matched.estimate.size()) + " poses");
    const std::string fault =
        faultOfFrames(evaluation::findFrameMismatch(matched.reference, matched.estimate),
                      settings.Tr.has_value());
    if (!fault.empty()) throw Error(pair + fault);

    ReportRow row =
        evaluation::score(matched.reference, matched.estimate, settings.lengths_m, settings.delta);
    row.name = name;
    row.sequence = fs::path(referenceFile).stem().string();
    if (row.kitti.segments == 0) {
        const std::string lengths = textOf(evaluation::suggestedLengths_m(row.length_m));
        cli::inform(pair +
                    mrpt::format("the path of %.1f m is too short for the lengths asked for",
                                 row.length_m) +
                    (lengths.empty() ? "" : "; try --lengths " + lengths));
    }
    return row;
}

std::vector<ReportRow> rowsOf(const std::string& reference, const std::vector<Estimate>& estimates,
                              const Settings& settings) {
    std::vector<ReportRow> rows;
    if (!fs::is_directory(reference)) {
        for (const auto& [name, path] : estimates)
            rows.push_back(
                rowOf(name, reference, poseFile(path, settings.Tr.has_value()), settings));
        return rows;
    }
    std::set<std::vector<std::string>> sets;
    for (const auto& [name, path] : estimates) {
        const auto files = sharedFiles(reference, path);
        sets.insert(files);
        std::vector<ReportRow> own;
        own.reserve(files.size());
        for (const auto& file : files)
            own.push_back(rowOf(name, (fs::path(reference) / file).string(),
                                (fs::path(path) / file).string(), settings));
        rows.insert(rows.end(), own.begin(), own.end());
        rows.push_back(evaluation::averageOf(own));
    }
    if (sets.size() > 1)
        cli::warn("the estimates cover different sequences: do not compare their averages");
    return rows;
}

void refuseReport(const std::string& folder, bool force) {
    if (folder.empty() || !fs::exists(folder)) return;
    if (!fs::is_directory(folder))
        throw Error("'" + folder + "' is a file; name a folder for the report");
    if (!fs::is_empty(folder)) cli::refuseExisting(folder, force);
}

void writeReport(const std::vector<ReportRow>& rows, const fs::path& folder) {
    std::error_code fault;
    fs::create_directories(folder, fault);
    if (fault) throw Error("cannot make folder '" + folder.string() + "': " + fault.message());
    io::replaceTextFile((folder / "metrics.tsv").string(),
                        [&](std::ostream& out) { evaluation::writeMetricsTsv(rows, out); });
    io::replaceTextFile((folder / "lengths.tsv").string(),
                        [&](std::ostream& out) { evaluation::writeLengthsTsv(rows, out); });
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd(
        "Scores trajectories against a reference: KITTI's translation error (percent) and rotation "
        "error (deg/100 m), both means over segments; APE (RMSE in metres after rigid alignment, "
        "no scale); RPE (RMSE over --delta poses, metres and degrees). '-' stands for a figure "
        "that the drive is too short for. Poses of TUM files are matched by time (within 0.02 s), "
        "all others by row. For two folders, every NN.txt in both is one sequence, and a row 'avg' "
        "follows: the plain mean of the sequences' errors, as in papers on KITTI, with the sums of "
        "lengths and segments.",
        ' ', kVersion);
    TCLAP::ValueArg<std::string> reference(
        "r", "ref", "Reference: a pose file (KITTI or TUM), or a folder of them (NN.txt)", true, "",
        "REF.txt|DIR", cmd);
    TCLAP::MultiArg<std::string> estimates(
        "e", "est",
        "Estimate: a pose file, a folder that delio-slam has written, or, if --ref is a folder, a "
        "folder of pose files; may be given again",
        true, "[NAME=]EST.txt|DIR", cmd);
    TCLAP::ValueArg<std::string> calibration(
        "c", "calib",
        "The estimates are in the LiDAR frame; Tr of this file brings them to cam0 (for folders: "
        "one Tr for every sequence)",
        false, "", "calib.txt", cmd);
    LengthsConstraint lengthsConstraint;
    TCLAP::ValueArg<std::string> lengths(
        "l", "lengths", "Lengths of KITTI's segments in metres (default 100,200,...,800)", false,
        textOf(evaluation::kittiLengths_m()), &lengthsConstraint, cmd);
    DeltaConstraint deltaConstraint;
    TCLAP::ValueArg<int> delta("d", "delta", "Poses that RPE spans (default 1)", false, 1,
                               &deltaConstraint, cmd);
    std::vector<std::string> formats = {"table", "tsv"};
    TCLAP::ValuesConstraint<std::string> formatsConstraint(formats);
    TCLAP::ValueArg<std::string> format("f", "format", "Form of the results (default table)", false,
                                        "table", &formatsConstraint, cmd);
    TCLAP::ValueArg<std::string> output(
        "o", "output", "Folder for metrics.tsv, and lengths.tsv with the errors per segment length",
        false, "", "REPORT_DIR", cmd);
    TCLAP::SwitchArg force("", "force", "Write into a report folder that is not empty", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "Say what is compared with what", cmd);

    Settings settings;
    return cli::run(cmd, argc, argv, verbose, [&] {
        settings.verbose = verbose.getValue();
        std::vector<Estimate> compared;
        for (const auto& text : estimates.getValue()) compared.push_back(estimateOf(text));
        if (const std::string fault = faultOfNames(compared); !fault.empty()) {
            cli::inform(fault + "; see --help");
            return cli::kExitBadCommandLine;
        }
        refuseReport(output.getValue(), force.getValue());

        settings.lengths_m = lengthsOf(lengths.getValue());
        settings.delta = static_cast<std::size_t>(delta.getValue());
        if (calibration.isSet()) {
            const auto read = io::readCalibration(calibration.getValue());
            if (!read.hasTr)
                throw Error("'" + calibration.getValue() +
                            "' has no Tr, which brings the LiDAR frame to cam0");
            settings.Tr = read.Tr;
        }
        const auto rows = rowsOf(reference.getValue(), compared, settings);
        if (!output.getValue().empty()) writeReport(rows, output.getValue());
        if (format.getValue() == "tsv")
            evaluation::writeMetricsTsv(rows, std::cout);
        else
            evaluation::writeTable(rows, std::cout);
        if (!std::cout.flush()) throw Error("cannot write the results to stdout");
        return cli::kExitSuccess;
    });
}
