// delio-slam: a rawlog in; trajectory, pose graph, map, scene and pictures out.
#include <malloc.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iostream>
#include <sstream>
#include <thread>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/io/g2o.h"
#include "delio/io/scan_reader.h"
#include "delio/picture/illustrate.h"
#include "delio/run/run.h"
#include "delio/version.h"
#include "initial_pose.h"
#include "live_view.h"
#include "output_folder.h"
#include "run_table.h"
#include "several_drives.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

using Text = TCLAP::ValueArg<std::string>;
using Number = TCLAP::ValueArg<cli::Count>;
using Switch = TCLAP::SwitchArg;

struct CommandLine {
    /** `runs`: input and output are needed. */
    explicit CommandLine(bool runs)
        : input("i", "input",
                "Rawlog to read, or a posegraph.g2o to optimise again; several drives are joined "
                "where they meet",
                runs, "IN.rawlog", cmd),
          output("o", "output", "Folder for the results", runs, "", "OUTDIR", cmd) {}

    TCLAP::CmdLine cmd{"delio-slam: LiDAR odometry, pose graph and map of a rawlog", ' ', kVersion};
    TCLAP::MultiArg<std::string> input;
    Text output;
    Text profile{"", "profile", "accurate, paper or paper-literal", false, "accurate", "NAME", cmd};
    Text config{"c",          "config", "Options that differ from the profile's", false, "",
                "CONFIG.ini", cmd};
    TCLAP::MultiArg<std::string> set{
        "", "set", "One option; may be repeated", false, "section.key=value", cmd};
    Switch printConfig{"", "print-config", "Print all options with their meanings, and end", cmd};
    Number start{"", "start", "First scan, from 0", false, {}, "N", cmd};
    Number count{"", "count", "How many scans to use at most; 0: all", false, {}, "N", cmd};
    Number every{"", "every", "Use every N-th scan only", false, {1}, "N", cmd};
    Text label{"", "sensor-label", "Sensor to use; default: that of the first scan", false, "", "L",
               cmd};
    Text images{"", "images", "Folder of the rawlog's external files", false, "", "DIR", cmd};
    Number threads{"", "threads", "Threads to use; 0: all", false, {}, "N", cmd};
    Text truth{"",
               "ground-truth",
               "True poses; default: IN.poses.txt if it is there",
               false,
               "",
               "POSES.txt",
               cmd};
    std::vector<std::string> frames{"cam0", "vehicle"};
    TCLAP::ValuesConstraint<std::string> frameNames{frames};
    Text truthFrame{"", "ground-truth-frame", "Frame of the true poses", false, "cam0", &frameNames,
                    cmd};
    Text map{"",
             "map",
             "Localise the drive in a stored map: map.delio, or the folder of the run that made it",
             false,
             "",
             "OLD",
             cmd};
    Text initialPose{"",
                     "initial-pose",
                     "Where the vehicle is at the first scan in that map, to some metres and "
                     "degrees: looked for there only",
                     false,
                     "",
                     "X,Y,Z,YAW_DEG",
                     cmd};
    Switch extend{"", "extend", "Add what is new to that map: OUTDIR/map.delio is both", cmd};
    Switch keepDynamic{"", "keep-dynamic",
                       "Write what was taken out of the map as moving, too: map_dynamic.ply", cmd};
    Switch noMap{"", "no-map", "Leave out map, scene and map.png", cmd};
    Switch noLoops{"", "no-loops", "Do not search for places that the drive comes back to", cmd};
    Switch noGraph{"", "no-graph", "Leave out the pose graph's optimisation, and loops", cmd};
    Switch gui{"", "gui", "Show the drive in a window while it is processed", cmd};
    Switch force{"", "force", "Overwrite what exists", cmd};
    Switch verbose{"", "verbose", "A line for each scan, and all the text of errors", cmd};
};

std::string textOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    in.peek();  // fails for a folder
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/** From the weakest to the strongest: the profile, what the drive says of itself, -c, --set. */
Options optionsFor(CommandLine& line, const std::optional<io::DriveMeta>& meta) {
    Options options = Options::forDrive(line.profile.getValue(), meta);
    if (line.config.isSet()) options.load(textOf(line.config.getValue()));
    for (const auto& assignment : line.set.getValue()) options.set(assignment);
    options.check();
    return options;
}

/** Every option with its meaning. What follows from the drive unless it is set is a comment: a file
 *  made of this leaves it to the drive. */
void printConfig(CommandLine& line) {
    io::DriveMeta other;  // than a drive that says nothing, in all that options follow
    other.verticalCorrectionDeg = 1;
    other.motionCompensated = true;
    other.source = "kitti-raw";
    std::stringstream own, ofOther;
    optionsFor(line, {}).write(own);
    optionsFor(line, other).write(ofOther);
    for (std::string text, otherText; std::getline(own, text) && std::getline(ofOther, otherText);)
        std::cout << (text == otherText ? "" : "# ") << text << "\n";
}

run::RunSettings settingsFor(CommandLine& line, int argc, char** argv) {
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

struct Reading {
    std::optional<Scan> scan;  //!< nothing at the end
    std::optional<double> fraction;
};

/** The next scan after some that are passed over. */
Reading read(io::ScanReader& reader, unsigned passedOver) {
    for (unsigned i = 0; i < passedOver; ++i)
        if (!reader.skip()) break;
    auto scan = reader.next();
    return {std::move(scan), reader.fraction()};
}

void warnOfOthers(const io::ScanReader& reader,
                  const std::function<void(const std::string&)>& warn) {
    for (const auto& other : reader.otherLabels())
        warn("scans of sensor '" + other + "' were not used; see --sensor-label");
}

/** Scans into the run until the end, the wanted count, an interrupt or a fault in the rawlog. With
 *  more than one thread each is read while the one before is registered: `read_ms` is what is
 *  waited for. */
void process(CommandLine& line, Reading now, io::ScanReader& reader, double read_ms,
             run::Run& run) {
    const unsigned count = line.count.getValue(), passedOver = line.every.getValue() - 1;
    const auto policy = line.threads.getValue() == 1 ? std::launch::deferred : std::launch::async;
    cli::Progress progress("scans", count);
    try {
        for (std::size_t done = 1; now.scan; ++done) {
            // A fault in a scan that is not wanted is none: the last one is not read beyond.
            std::future<Reading> next;
            if (done != count) next = std::async(policy, [&] { return read(reader, passedOver); });
            const auto& row = run.process(*now.scan, read_ms);
            if (line.verbose.getValue()) cli::inform(describe(row));
            progress.update(done, now.fraction);
            if (cli::interrupted() || done == count) break;
            Stopwatch watch;
            now = next.get();
            read_ms = watch.lap_ms();
        }
    } catch (const std::exception& e) {
        run.fail(plainMessage(e));
    }
    warnOfOthers(reader, [&](const std::string& text) { run.warn(text); });
}

std::shared_ptr<LiveView> liveViewFor(CommandLine& line, const Options& options, run::Run& run) {
    if (!line.gui.getValue()) return nullptr;
    auto view = std::make_shared<LiveView>(options.paper);
    run.attach(view);
    return view;
}

/** One drive, from `input` to the folder `settings.folder`. */
DriveResult slamDrive(CommandLine& line, const std::string& input, run::RunSettings settings) {
    const auto reader = io::openScans(input, line.label.getValue(), line.images.getValue());
    const Options options = optionsFor(line, reader->meta());
    Stopwatch watch;
    auto first = read(*reader, line.start.getValue());
    const double read_ms = watch.lap_ms();
    if (!first.scan) {
        warnOfOthers(*reader, cli::warn);
        const unsigned start = line.start.getValue();
        const std::string label = line.label.getValue();
        throw Error("'" + input + "' holds no LiDAR scans" +
                    (label.empty() ? "" : " of sensor '" + label + "'") +
                    (start > 0 ? " after --start " + std::to_string(start) : ""));
    }
    if (cli::interrupted()) return {cli::kExitInterrupted};
    settings.sensorLabel = reader->label();
    settings.drive = fs::path(input).stem().string();
    run::Run run(options, settings);
    if (!reader->meta())
        run.warn("no '" + io::sidecarPath(input, ".meta.yaml") +
                 "': no vertical correction, times are Unix seconds");
    run.readSideFiles(input, line.truth.getValue(), line.truthFrame.getValue() == "cam0");
    const auto view = liveViewFor(line, options, run);
    process(line, std::move(first), *reader, read_ms, run);

    const auto& record = run.record();
    const bool anyUsed = record.predicted() < record.rows.size();
    if (!anyUsed)
        run.fail("no scan of '" + input +
                 "' could be used: " + record.rows.front().report.step.reason);
    run.finish(record.fault.empty() && !cli::interrupted());
    const std::string fault =
        run::RunFolder(settings.folder)
            .write(record, anyUsed ? run.maps() : run::RunMaps{}, picture::illustrate);
    printTable(record, settings.folder, std::cout);
    if (!fault.empty()) throw Error(fault);
    if (cli::interrupted()) return {cli::kExitInterrupted, record.extended, false};
    if (view && view->isOpen()) cli::inform("done; close the window to end");
    while (view && view->isOpen() && !cli::interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return {cli::kExitSuccess, record.extended, record.addedSubmaps > 0};
}

/** IN may be a pose graph: it is optimised again. */
int optimiseGraph(CommandLine& line, const std::string& input, const run::RunSettings& settings) {
    const auto record = run::optimiseAgain(io::loadG2o(input), optionsFor(line, {}), settings);
    const std::string fault =
        run::RunFolder(settings.folder).write(record, {}, picture::illustrate);
    if (!fault.empty()) throw Error(fault);
    return cli::kExitSuccess;
}

bool isGraph(const std::string& input) { return fs::path(input).extension() == ".g2o"; }

/** Why the command line contradicts itself; empty: it does not. */
std::string contradictionIn(CommandLine& line) {
    const auto& inputs = line.input.getValue();
    if (line.every.getValue() == 0) return "--every has to be 1 or more";
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
    if (line.truth.isSet() || line.images.isSet() || line.initialPose.isSet())
        return "--ground-truth, --images and --initial-pose are one drive's: they do not go with "
               "several";
    for (const auto& input : inputs)
        if (isGraph(input)) return "a pose graph is optimised alone";
    return "";
}

/** Nothing that is read may be overwritten. */
void checkFolders(CommandLine& line) {
    if (!line.map.isSet()) return;
    const fs::path map = run::storedMapIn(line.map.getValue());
    std::error_code ignored;
    if (fs::equivalent(fs::absolute(map).parent_path(), line.output.getValue(), ignored))
        throw Error("the results would replace the map '" + line.map.getValue() +
                    "': choose another folder than its own");
}

int slam(CommandLine& line, int argc, char** argv) {
    cli::catchInterrupts();
    try {
        optionsFor(line, {});
        if (line.initialPose.isSet()) initialPoseIn(line.initialPose.getValue());
        const std::string contradiction = contradictionIn(line);
        if (!contradiction.empty()) throw Error(contradiction);
        if (line.printConfig.getValue()) {
            printConfig(line);
            return cli::kExitSuccess;
        }
    } catch (const Error& e) {
        cli::inform(e.what());
        return cli::kExitBadCommandLine;
    }
    const unsigned threads = line.threads.getValue();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      threads > 0 ? threads : std::thread::hardware_concurrency());
    const auto& inputs = line.input.getValue();
    for (const auto& input : inputs)
        if (!fs::is_regular_file(input))
            throw Error("cannot read '" + input +
                        "': " + (fs::exists(input) ? "it is no file" : "no such file"));
    checkFolders(line);
    const OutputFolder folder(line.output.getValue(), line.force.getValue());
    const auto settings = settingsFor(line, argc, argv);
    if (inputs.size() > 1)
        return slamSeveral(inputs, settings, [&](const auto& input, const auto& its) {
            return slamDrive(line, input, its);
        });
    return isGraph(inputs.front()) ? optimiseGraph(line, inputs.front(), settings)
                                   : slamDrive(line, inputs.front(), settings).exitCode;
}
}  // namespace

int main(int argc, char** argv) {
    // Clouds and maps go back to the system when they are dropped, whichever thread made them.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
    const bool runs = std::none_of(
        argv, argv + argc, [](const char* word) { return std::string(word) == "--print-config"; });
    CommandLine line(runs);
    const int exitCode =
        cli::run(line.cmd, argc, argv, line.verbose, [&] { return slam(line, argc, argv); });
    if (line.gui.getValue()) {
        // All is written. MRPT 2.5.8's window thread crashes now and then when the program's end
        // takes its objects away from under it, so they stay.
        std::cout.flush();
        std::_Exit(exitCode);
    }
    return exitCode;
}
