#include "eval_inputs.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "cli.h"
#include "delio/error.h"
#include "delio/evaluation/association.h"
#include "delio/evaluation/frame_check.h"
#include "delio/io/scan_table.h"
#include "delio/io/trajectory.h"

namespace delio {
namespace fs = std::filesystem;
using evaluation::Comparison;

namespace {
constexpr double kKittiInterval_s = 0.1;

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

/** A sequence of which there is a reference and an estimate. */
struct Sequence {
    std::string reference;  // pose files
    std::string estimate;
};

/** The sequences NN of two folders: NN.txt in the one, NN.txt or a folder NN that delio-slam has
 *  written in the other. */
std::vector<Sequence> sharedSequences(const fs::path& reference, const fs::path& estimate,
                                      bool calibrationGiven) {
    if (!fs::is_directory(estimate))
        throw Error("'" + estimate.string() + "' is no folder, but the reference is one ('" +
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
        else if (fs::exists(folder / "trajectory_kitti.txt"))
            sequences.push_back({file.string(), poseFile(folder.string(), calibrationGiven)});
    }
    if (sequences.empty())
        throw Error("'" + estimate.string() + "' has no pose file (NN.txt) that is in '" +
                    reference.string() + "' too");
    return sequences;
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

/** The scans.csv beside a trajectory that delio-slam has written. */
std::optional<io::ScanTable> scanTableBeside(const fs::path& estimateFile, std::size_t poses) {
    const fs::path file = estimateFile.parent_path() / "scans.csv";
    if (estimateFile.filename().string().rfind("trajectory", 0) != 0 || !fs::exists(file))
        return {};
    auto table = io::readScanTable(file.string());
    if (table.scans.size() == poses) return table;
    cli::warn("'" + file.string() + "' has " + std::to_string(table.scans.size()) +
              " scans for the " + std::to_string(poses) + " poses beside it and is left out");
    return {};
}

/** Of a reference with a row for every scan, the rows of the scans that were used: delio-slam's
 *  --start, --count and --every leave some out. */
void keepUsedScans(io::Trajectory& reference, const io::ScanTable& table, const std::string& pair) {
    const std::size_t rows = reference.poses.size();
    if (rows == table.scans.size() || table.scans.back() >= rows || !reference.stamps_s.empty())
        return;
    io::Trajectory used;
    for (const std::size_t scan : table.scans) used.poses.push_back(reference.poses[scan]);
    reference = std::move(used);
    cli::inform(pair + "scored on the " + std::to_string(table.scans.size()) + " of " +
                std::to_string(rows) + " scans that were used, as scans.csv has them");
}

/** Seconds of each pair of poses. */
void setTimes(Comparison& comparison, const evaluation::Association& matched,
              const std::optional<io::ScanTable>& table) {
    for (std::size_t i = 0; i < matched.estimate.size(); ++i) {
        const std::size_t row = matched.estimateRows[i];
        if (!matched.stamps_s.empty())
            comparison.times_s.push_back(matched.stamps_s[i] - matched.stamps_s[0]);
        else if (table)
            comparison.times_s.push_back(table->stamps_s[row] - table->stamps_s[0]);
        else
            comparison.times_s.push_back(kKittiInterval_s * static_cast<double>(i));
        if (table) comparison.predicted.push_back(table->predicted[row]);
    }
    comparison.timesAreAssumed = matched.stamps_s.empty() && !table;
}
}  // namespace

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

std::string textOf(const std::vector<double>& lengths) {
    std::string text;
    for (const double length : lengths)
        text += (text.empty() ? "" : ",") + mrpt::format("%g", length);
    return text;
}

Comparison compareFiles(const std::string& name, const std::string& referenceFile,
                        const std::string& estimateFile, const EvalSettings& settings) {
    auto reference = io::readTrajectory(referenceFile);
    auto estimate = io::readTrajectory(estimateFile);
    const std::string pair = "'" + estimateFile + "' against '" + referenceFile + "': ";
    const auto table = scanTableBeside(estimateFile, estimate.poses.size());
    if (table && estimate.stamps_s.empty()) keepUsedScans(reference, *table, pair);
    if (settings.Tr) estimate = io::lidarToCam0(estimate, *settings.Tr);

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

    Comparison comparison;
    setTimes(comparison, matched, table);
    comparison.row =
        evaluation::score(matched.reference, matched.estimate, settings.lengths_m, settings.delta);
    auto& row = comparison.row;
    row.name = name;
    row.sequence = fs::path(referenceFile).stem().string();
    if (row.kitti.segments == 0) {
        const std::string lengths = textOf(evaluation::suggestedLengths_m(row.length_m));
        cli::inform(pair +
                    mrpt::format("the path of %.1f m is too short for the lengths asked for",
                                 row.length_m) +
                    (lengths.empty() ? "" : "; try --lengths " + lengths));
    }
    comparison.reference = std::move(matched.reference);
    comparison.estimate = std::move(matched.estimate);
    return comparison;
}

std::vector<Comparison> compare(const std::string& reference, const Estimate& estimate,
                                const EvalSettings& settings) {
    const bool calibrationGiven = settings.Tr.has_value();
    if (!fs::is_directory(reference))
        return {compareFiles(estimate.name, reference, poseFile(estimate.path, calibrationGiven),
                             settings)};
    std::vector<Comparison> comparisons;
    for (const auto& sequence : sharedSequences(reference, estimate.path, calibrationGiven))
        comparisons.push_back(
            compareFiles(estimate.name, sequence.reference, sequence.estimate, settings));
    return comparisons;
}
}  // namespace delio
