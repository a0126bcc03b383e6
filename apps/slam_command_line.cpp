#include "slam_command_line.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/run/run_folder.h"
#include "initial_pose.h"

namespace delio {
namespace fs = std::filesystem;

namespace {
std::string textOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    in.peek();  // fails for a folder
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}
}  // namespace

cli::HelpText slamHelp() {
    using Folder = run::RunFolder;
    cli::HelpText help;
    help.about =
        "True poses are found where KITTI keeps them. The same input gives the same bytes for any "
        "--threads.";
    help.sections = cli::optionSections(Options::ofProfile("accurate").stages());
    const auto isThere = [&](const cli::HelpText::Row& row) {
        return std::any_of(help.sections.begin(), help.sections.end(),
                           [&](const auto& other) { return other.name == row.name; });
    };
    for (auto& row : cli::optionSections(Options::ofProfile("paper").stages()))
        if (!isThere(row)) help.sections.push_back({row.name, "profile paper: " + row.meaning});
    const auto both = [](const std::string& one, const std::string& other) {
        return one + ", " + other;
    };
    help.writes = {
        {Folder::kTrajectory, "final poses, 12 numbers a line"},
        {both(Folder::kOdometry, Folder::kOdometryCam0), "poses before the pose graph"},
        {Folder::kCam0, "final poses in KITTI's cam0 frame"},
        {Folder::kTum, "final poses as t x y z qx qy qz qw"},
        {both(Folder::kGraph, Folder::kMrptGraph), "the pose graph"},
        {both(Folder::kPly, Folder::kScene), "the map: points, scene for SceneViewer3D"},
        {Folder::kMapPage, "the map as a page for a browser"},
        {Folder::kStoredMap, "the map to come back to, for --map"},
        {Folder::kSimplemap, "keyframes with their points, for MRPT's programs"},
        {both(Folder::kMapPicture, Folder::kTrajectoryPicture), "pictures"},
        {Folder::kRemovalPicture, "what moved and was taken out of the map"},
        {Folder::kDynamicPly, "its points, with --keep-dynamic"},
        {Folder::kScans, "a row a scan: times, quality, why it was predicted"},
        {Folder::kLoops, "a row a pair of places that was compared"},
        {Folder::kLocalisation, "with --map: where in that map each scan was"},
        {Folder::kJoints, "with --extend: the edges between the two maps"},
        {Folder::kSummary, "the run in numbers"},
        {Folder::kConfig, "every option that had an effect, for -c"},
        {Folder::kDrives, "of several drives: which is in which map"},
    };
    help.examples = {{{"delio-slam -i dataset/sequences/07 -o 07-results", "A sequence of KITTI"},
                      {"delio-slam -i b.bag -o b --sensor-label /points --map 07-results",
                       "Where in that map was another drive"}}};
    help.interrupted = "what was done is written";
    return help;
}

Options optionsFor(SlamCommandLine& line, const std::optional<io::DriveMeta>& meta) {
    Options options = Options::forDrive(line.profile.getValue(), meta);
    if (line.config.isSet()) options.load(textOf(line.config.getValue()));
    for (const auto& assignment : line.set.getValue()) options.set(assignment);
    options.check();
    return options;
}

void printConfig(SlamCommandLine& line) {
    io::DriveMeta other;  // than a drive that says nothing, in all that options follow
    other.verticalCorrectionDeg = 1;
    other.motionCompensated = true;
    other.source = "kitti-raw";
    std::stringstream own, ofOther;
    optionsFor(line, {}).write(own);
    Options otherOptions = optionsFor(line, other);
    otherOptions.map = otherOptions.map.atScale(0.5);
    otherOptions.write(ofOther);
    for (std::string text, otherText; std::getline(own, text) && std::getline(ofOther, otherText);)
        std::cout << (text == otherText ? "" : "# ") << text << "\n";
}

run::RunSettings settingsFor(SlamCommandLine& line, int argc, char** argv) {
    run::RunSettings settings;
    settings.profile = line.profile.getValue();
    settings.command.assign(argv, argv + argc);
    settings.folder = line.output.getValue();
    settings.graph = !line.noGraph.getValue();
    settings.map = !line.noMap.getValue();
    settings.keepDynamic = line.keepDynamic.getValue();
    settings.loops = !line.noLoops.getValue();
    settings.storedMap = line.map.getValue();
    settings.extend = line.extend.getValue();
    if (line.initialPose.isSet()) settings.initialPose = initialPoseIn(line.initialPose.getValue());
    settings.onWarning = cli::warn;
    return settings;
}

io::ScanSource sourceFor(SlamCommandLine& line, const std::string& input) {
    return {input, line.label.getValue(), line.images.getValue(), line.sensorInfo.getValue()};
}

bool isGraph(const std::string& input) { return fs::path(input).extension() == ".g2o"; }

std::string contradictionIn(SlamCommandLine& line) {
    const auto& inputs = line.input.getValue();
    if (line.every.getValue() == 0) return "--every has to be 1 or more";
    if (line.threads.getValue() > cli::kMostThreads)
        return "--threads has to be " + std::to_string(cli::kMostThreads) + " or less; 0: all";
    if (line.initialPose.isSet() && !line.map.isSet())
        return "--initial-pose is a pose in a stored map: it needs --map";
    if (line.extend.isSet() && !line.map.isSet())
        return "--extend adds to a stored map: it needs --map";
    if (line.noMap.isSet() && line.keepDynamic.isSet())
        return "--keep-dynamic keeps what is taken out of the map: it does not go with --no-map";
    if (line.noMap.isSet() && (line.extend.isSet() || inputs.size() > 1))
        return "--no-map does not go with what is to become one map";
    if (inputs.size() < 2) return "";
    if (line.map.isSet() && !line.extend.isSet())
        return "several drives are joined to one map: with --map that needs --extend";
    if (line.truth.isSet() || line.images.isSet() || line.sensorInfo.isSet() ||
        line.initialPose.isSet())
        return "--ground-truth, --images, --sensor-info and --initial-pose are one drive's: they "
               "do "
               "not go with several";
    for (const auto& input : inputs)
        if (isGraph(input)) return "a pose graph is optimised alone";
    for (const auto& input : inputs)
        if (input == "-") return "a drive from standard input is processed alone";
    return "";
}
}  // namespace delio
