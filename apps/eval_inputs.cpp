#include "eval_inputs.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/formats/scan_table.h"
#include "delio/formats/trajectory.h"
#include "delio/run/run_folder.h"

namespace delio {
namespace fs = std::filesystem;
using evaluation::Comparison;
using run::RunFolder;

namespace {
/** Pose file of an estimate: for a result folder, its trajectory in the cam0 frame, or the one that
 *  --calib transforms to it. */
std::string poseFile(const std::string& path, bool calibrationGiven, bool odometry = false) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    const bool isCam0 = folder.has(RunFolder::kCam0) && !calibrationGiven;
    if (isCam0 && odometry && folder.has(RunFolder::kOdometryCam0))
        return folder.path(RunFolder::kOdometryCam0);
    if (isCam0) return folder.path(RunFolder::kCam0);  // nothing has changed the odometry
    if (odometry) return folder.path(RunFolder::kOdometry);
    if (folder.has(RunFolder::kTrajectory)) return folder.path(RunFolder::kTrajectory);
    throw Error(
        "'" + path + "' is a folder without " + RunFolder::kTrajectory +
        "; to score every NN.txt in it, give a folder as --ref; otherwise name a pose file");
}

/** A sequence of which there is a reference and an estimate. */
struct Sequence {
    std::string reference;  // pose files
    std::string estimate;   // a pose file, or a folder that delio-slam has written
};

bool hasLoops(const Sequence& sequence) {
    const RunFolder folder(sequence.estimate);
    return folder.has(RunFolder::kSummary) && folder.summary().loops_closed > 0;
}

/** The sequences NN of two folders: NN.txt in the one, NN.txt or a folder NN that delio-slam has
 *  written in the other. */
std::vector<Sequence> sharedSequences(const fs::path& reference, const fs::path& estimate) {
    if (!fs::is_directory(reference)) return {{reference.string(), estimate.string()}};
    if (!fs::is_directory(estimate))
        throw Error("'" + estimate.string() + "' is not a folder, but the reference is one ('" +
                    reference.string() + "'); give two folders or two files");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(reference))
        if (entry.path().extension() == ".txt") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Sequence> sequences;
    for (const auto& file : files) {
        const fs::path own = estimate / file.filename(), folder = estimate / file.stem();
        if (fs::exists(own))
            sequences.push_back({file.string(), own.string()});
        else if (RunFolder(folder).has(RunFolder::kTrajectory))
            sequences.push_back({file.string(), folder.string()});
    }
    if (sequences.empty())
        throw Error("'" + estimate.string() + "' and '" + reference.string() +
                    "' have no NN.txt in common");
    return sequences;
}

/** Message for trajectories of different frames. */
std::string faultOfFrames(const evaluation::WrongFrames& fault, bool calibrationGiven) {
    if (fault.mismatch() == evaluation::FrameMismatch::lidarAgainstCamera)
        return std::string(fault.what()) + "; give --calib calib.txt to bring the estimate to cam0";
    if (calibrationGiven)
        return "the estimate seems to be in the cam0 frame already, or the reference in the LiDAR "
               "frame; leave out --calib";
    return std::string(fault.what()) + "; give both in the same frame";
}

/** The scans.csv beside a trajectory that delio-slam has written. */
std::optional<io::ScanTable> scanTableBeside(const fs::path& estimateFile, std::size_t poses) {
    const fs::path file = estimateFile.parent_path() / RunFolder::kScans;
    if (estimateFile.filename().string().rfind("trajectory", 0) != 0 || !fs::exists(file))
        return {};
    auto table = io::readScanTable(file.string());
    if (table.scans.size() == poses) return table;
    cli::warn("'" + file.string() + "' has " + std::to_string(table.scans.size()) +
              " scans but there are " + std::to_string(poses) + " poses next to it; it is ignored");
    return {};
}

/** evaluation::compare() with messages for the command line. */
Comparison compareOrSayWhy(const io::Trajectory& reference, const io::Trajectory& estimate,
                           const EvalSettings& settings, const io::ScanTable* table,
                           const std::string& pair) {
    try {
        return evaluation::compare(reference, estimate, settings.comparison, table);
    } catch (const evaluation::WrongFrames& e) {
        throw Error(pair + faultOfFrames(e, settings.Tr.has_value()));
    } catch (const Error& e) {
        throw Error(pair + e.what());
    }
}

/** True if more rows follow the last scan than between two scans. */
bool goesOnAfter(const io::ScanTable& table, std::size_t rows) {
    const auto& scans = table.scans;
    const std::size_t step = scans.size() > 1 ? scans.back() - scans[scans.size() - 2] : 1;
    return rows > scans.back() + step;
}

/** Prints notes about the compared poses. */
void describe(const Comparison& comparison, const std::optional<io::ScanTable>& table, bool verbose,
              const std::string& pair) {
    const std::string matched = std::to_string(comparison.reference.size());
    const std::size_t rows = comparison.reference.size() + comparison.unusedReference;
    if (comparison.unusedReference > 0 && goesOnAfter(*table, rows))
        cli::warn(pair + "the reference has " + std::to_string(rows) +
                  " rows, but the last scan is number " + std::to_string(table->scans.back()) +
                  "; row N was taken for scan N, which is wrong if the recording has fewer scans "
                  "than the reference has rows");
    else if (comparison.unusedReference > 0)
        cli::inform(pair + "scored on the " + matched + " of " + std::to_string(rows) +
                    " scans used according to " + RunFolder::kScans);
    if (comparison.unmatchedReference + comparison.unmatchedEstimate > 0)
        cli::warn(pair + matched + " poses match in time; " +
                  std::to_string(comparison.unmatchedEstimate) + " of the estimate and " +
                  std::to_string(comparison.unmatchedReference) +
                  " of the reference have no counterpart and are ignored");
    else if (verbose)
        cli::inform(pair + matched + " poses");
    const auto& row = comparison.row;
    if (comparison.framesAreUnknown)
        cli::warn(pair + mrpt::format("the path of %.1f m is too short to check that both are in "
                                      "the same frame (LiDAR or camera)",
                                      row.length_m));
    if (!comparison.referenceFault.empty()) cli::warn(pair + comparison.referenceFault);
    if (row.kitti.segments > 0) return;
    const std::string lengths = textOf(evaluation::suggestedLengths_m(row.length_m));
    cli::inform(
        pair +
        mrpt::format("the path of %.1f m is too short for these segment lengths", row.length_m) +
        (lengths.empty() ? "" : "; try --lengths " + lengths));
}
}  // namespace

Estimate estimateOf(const std::string& text) {
    const auto equals = text.find('=');
    if (equals != std::string::npos && !fs::exists(text))
        return {text.substr(0, equals), text.substr(equals + 1)};
    const fs::path path = fs::path(text).lexically_normal();
    const fs::path last = path.has_filename() ? path : path.parent_path();
    return {printable(last.stem().string()), text};
}

std::string faultOfNames(const std::vector<Estimate>& estimates) {
    std::set<std::string> names;
    for (const auto& estimate : estimates) {
        if (estimate.name.empty() || estimate.path.empty() ||
            estimate.name.find_first_of("\t\n\r") != std::string::npos)
            return "--est needs NAME=PATH; NAME must not contain tabs or line breaks";
        if (!names.insert(estimate.name).second)
            return "two estimates have the name '" + estimate.name +
                   "'; name them with --est NAME=PATH";
    }
    return "";
}

std::string textOf(const std::vector<double>& lengths) {
    std::string text;
    for (const double length : lengths)
        text += (text.empty() ? "" : ",") + mrpt::format("%g", length);
    return text;
}

Comparison compareFiles(const std::string& name, const std::string& referenceFile,
                        const std::string& estimateFile, const EvalSettings& settings) {
    const auto reference = io::readTrajectory(referenceFile);
    auto estimate = io::readTrajectory(estimateFile);
    const auto table = scanTableBeside(estimateFile, estimate.poses.size());
    if (settings.Tr) estimate = io::lidarToCam0(estimate, *settings.Tr);
    const std::string pair = "'" + estimateFile + "' against '" + referenceFile + "': ";
    auto comparison =
        compareOrSayWhy(reference, estimate, settings, table ? &*table : nullptr, pair);
    comparison.row.name = name;
    comparison.row.sequence = printable(fs::path(referenceFile).stem().string());
    describe(comparison, table, settings.verbose, pair);
    return comparison;
}

std::vector<Comparison> compareSequences(const std::string& reference, const Estimate& estimate,
                                         const EvalSettings& settings) {
    const bool calibrationGiven = settings.Tr.has_value();
    std::vector<Comparison> comparisons;
    const auto sequences = sharedSequences(reference, estimate.path);
    for (const auto& [truth, path] : sequences) {
        comparisons.push_back(
            compareFiles(estimate.name, truth, poseFile(path, calibrationGiven), settings));
        const RunFolder folder(path);
        if (folder.has(RunFolder::kMapPage))
            comparisons.back().mapPage = folder.path(RunFolder::kMapPage);
    }
    if (std::none_of(sequences.begin(), sequences.end(), hasLoops)) return comparisons;
    for (const auto& [truth, path] : sequences)
        if (RunFolder(path).has(RunFolder::kOdometry))
            comparisons.push_back(compareFiles(estimate.name + " (odometry)", truth,
                                               poseFile(path, calibrationGiven, true), settings));
    return comparisons;
}
}  // namespace delio
