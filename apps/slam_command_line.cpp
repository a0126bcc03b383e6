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

/** Adds those of a file to the options. */
void load(const std::string& path, Options& options) {
    const std::string byteOrderMark = "\xEF\xBB\xBF";  // of some editors
    std::string text = textOf(path);
    if (text.compare(0, byteOrderMark.size(), byteOrderMark) == 0)
        text.erase(0, byteOrderMark.size());
    try {
        options.load(text);
    } catch (const Error& e) {
        throw Error("'" + path + "': " + e.what());
    }
}
}  // namespace

cli::HelpText slamHelp() {
    using Folder = run::RunFolder;
    cli::HelpText help;
    help.about =
        "Ground truth is found automatically in KITTI's folder layout. Results have the same bytes "
        "for any --threads.";
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
        {Folder::kTrajectory, "final poses, KITTI format (12 numbers per line)"},
        {both(Folder::kOdometry, Folder::kOdometryCam0), "poses before pose-graph optimisation"},
        {Folder::kCam0, "final poses in KITTI's cam0 frame"},
        {Folder::kTum, "final poses, TUM format (t x y z qx qy qz qw)"},
        {Folder::kInterpolator,
         "final poses, MRPT's CPose3DInterpolator (Unix time, x y z yaw pitch roll)"},
        {both(Folder::kGeoreference, Folder::kGeoTrajectory),
         "with GNSS fixes: place on the earth; poses as latitude, longitude, height and UTM"},
        {both(Folder::kEnuTum, Folder::kGeoJson),
         "with GNSS fixes: poses in east-north-up, TUM format; line for a map viewer"},
        {Folder::kCloudTum,
         "with --map of an imported cloud with an offset: poses in its coordinates"},
        {Folder::kExtrinsics,
         "poses that were calibrated: of the IMU, of LiDARs; for --extrinsics"},
        {both(Folder::kGraph, Folder::kMrptGraph), "pose graph"},
        {both(Folder::kPly, Folder::kScene), "map points; scene for SceneViewer3D"},
        {Folder::kMapPage, "the map as an interactive page for a browser"},
        {Folder::kStoredMap, "the map for localisation with --map"},
        {Folder::kSimplemap, "keyframes with their points, for MRPT's programs"},
        {both(Folder::kMapPicture, Folder::kTrajectoryPicture), "pictures"},
        {Folder::kRemovalPicture, "dynamic points removed from the map, as a picture"},
        {Folder::kDynamicPly, "with --keep-dynamic: these points"},
        {Folder::kScans, "per scan: times, quality, reason for a prediction"},
        {Folder::kLoops, "per compared pair of places: result and reason"},
        {Folder::kLocalisation, "with --map: pose of each scan in that map"},
        {Folder::kJoints, "with --extend: edges between the two maps"},
        {Folder::kPackets, "of a live sensor: its packets, to run the drive again"},
        {Folder::kSummary, "summary of the run"},
        {Folder::kConfig, "all options used, for -c"},
        {Folder::kDrives, "with several drives: which map each is in"},
    };
    help.examples = {
        {{"delio-slam -i dataset/sequences/07 -o 07-results", "Process a KITTI sequence"},
         {"delio-slam -i b.bag -o b --sensor-label /points --map 07-results",
          "Localise another drive in that map"}}};
    help.interrupted = "results up to there are written";
    return help;
}

Options optionsFor(SlamCommandLine& line, const std::optional<io::DriveMeta>& meta) {
    Options options = Options::forDrive(line.profile.getValue(), meta);
    if (line.config.isSet()) load(line.config.getValue(), options);
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
    if (!std::cout.flush()) throw Error("cannot write the options to stdout");
}

run::RunSettings settingsFor(SlamCommandLine& line, int argc, char** argv) {
    run::RunSettings settings;
    settings.profile = line.profile.getValue();
    settings.command.assign(argv, argv + argc);
    settings.folder = line.output.getValue();
    settings.graph = !line.noGraph.getValue();
    settings.map = !line.noMap.getValue();
    settings.keepDynamic = line.keepDynamic.getValue();
    settings.gnss = !line.noGnss.getValue();
    settings.level = line.level.getValue();
    settings.loops = !line.noLoops.getValue();
    settings.storedMap = line.map.getValue();
    settings.extend = line.extend.getValue();
    settings.update = line.update.getValue();
    if (line.initialPose.isSet()) settings.initialPose = initialPoseIn(line.initialPose.getValue());
    settings.onWarning = cli::warn;
    return settings;
}

bool isLive(SlamCommandLine& line) {
    return line.input.getValue().size() == 1 && io::isLive(line.input.getValue().front());
}

io::ScanSource sourceFor(SlamCommandLine& line, const std::string& input) {
    io::ScanSource source{input, line.label.getValue(), line.images.getValue(),
                          line.sensorInfo.getValue()};
    source.extrinsicsFile = line.extrinsics.getValue();
    if (line.vehicleBox.isSet()) source.vehicle = io::vehiclePartsIn(line.vehicleBox.getValue());
    if (!io::isLive(input)) return source;
    const fs::path folder = line.output.getValue();
    source.live.record =
        line.record.isSet() ? line.record.getValue() : (folder / run::RunFolder::kPackets).string();
    if (line.noRecord.getValue()) source.live.record.clear();
    source.live.idle_s = line.idle.getValue();
    source.live.mostWaiting = line.queue.getValue();
    source.live.isEnded = cli::interrupted;
    source.live.onWarning = cli::warn;
    return source;
}

bool isGraph(const std::string& input) { return fs::path(input).extension() == ".g2o"; }

std::string contradictionIn(SlamCommandLine& line) {
    const auto& inputs = line.input.getValue();
    if (line.every.getValue() == 0) return "--every must be at least 1";
    if (line.threads.getValue() > cli::kMostThreads)
        return "--threads must be " + std::to_string(cli::kMostThreads) + " or less (0: all)";
    if (line.serve.getValue() > 65535) return "--serve must be 65535 or less (0: any free port)";
    if (line.initialPose.isSet() && !line.map.isSet())
        return "--initial-pose needs --map: it is a pose in the stored map";
    if (line.level.isSet() && line.noImu.isSet())
        return "--level needs the IMU that --no-imu leaves out";
    if (line.level.isSet() && line.map.isSet())
        return "--level cannot turn the stored map of --map";
    if (line.noGnss.isSet() && (line.gnss.isSet() || line.antenna.isSet()))
        return "--no-gnss excludes --gnss and --antenna";
    if (line.extend.isSet() && !line.map.isSet())
        return "--extend needs --map: it adds to the stored map";
    if (line.update.isSet() && !line.map.isSet())
        return "--update needs --map: it updates the stored map";
    if (line.update.isSet() && (line.extend.isSet() || inputs.size() > 1))
        return "--update takes one drive, without --extend";
    if (line.update.isSet() && line.noMap.isSet())
        return "--update and --no-map exclude each other";
    if (line.calibrateExtrinsics.isSet() &&
        (inputs.size() > 1 || isLive(line) || inputs.front() == "-" || isGraph(inputs.front())))
        return "--calibrate-extrinsics needs one recording as input";
    if (line.saveRawlog.isSet() && (inputs.size() > 1 || isLive(line) || inputs.front() == "-"))
        return "--save-rawlog needs one rawlog file as input";
    if (line.saveRawlog.isSet() && fs::path(line.saveRawlog.getValue()).extension() != ".rawlog")
        return "--save-rawlog needs the name of a rawlog: FILE.rawlog";
    if (line.noMap.isSet() && line.keepDynamic.isSet())
        return "--keep-dynamic and --no-map exclude each other";
    if (line.noMap.isSet() && (line.extend.isSet() || inputs.size() > 1))
        return "--no-map cannot be used when drives are joined to a map";
    for (const TCLAP::Arg* arg : std::initializer_list<const TCLAP::Arg*>{
             &line.record, &line.noRecord, &line.idle, &line.queue})
        if (arg->isSet() && !isLive(line))
            return "--" + arg->getName() + " needs a live sensor: -i udp://[ADDRESS:]PORT";
    if (line.record.isSet() && line.noRecord.isSet())
        return "--record and --no-record exclude each other";
    if (!(line.idle.getValue() >= 0)) return "--idle must be 0 or more";
    if (line.queue.getValue() == 0) return "--queue must be at least 1";
    if (inputs.size() < 2) return "";
    if (line.poses.isSet() || line.publish.isSet())
        return "--poses and --publish cannot be used with several drives";
    for (const auto& input : inputs)
        if (io::isLive(input)) return "a live sensor must be the only input";
    if (line.map.isSet() && !line.extend.isSet())
        return "several drives with --map also need --extend";
    if (line.truth.isSet() || line.images.isSet() || line.sensorInfo.isSet() ||
        line.initialPose.isSet() || line.gnss.isSet())
        return "--ground-truth, --images, --sensor-info, --initial-pose and --gnss cannot be used "
               "with several drives";
    for (const auto& input : inputs)
        if (isGraph(input)) return "a pose graph must be the only input";
    for (const auto& input : inputs)
        if (input == "-") return "standard input must be the only input";
    return "";
}
}  // namespace delio
