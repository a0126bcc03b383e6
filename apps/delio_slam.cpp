// delio-slam: a recording in; trajectory, pose graph, map, scene and pictures out.
#include <malloc.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <thread>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/formats/g2o.h"
#include "delio/picture/figures.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/playback.h"
#include "delio/run/run_folder.h"
#include "delio/run/save_rawlog.h"
#include "initial_pose.h"
#include "live_output.h"
#include "output_folder.h"
#include "overlap.h"
#include "pose_output.h"
#include "run_table.h"
#include "several_drives.h"
#include "slam_command_line.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

/** What is used of the recording. */
run::PlaybackSettings playbackOf(SlamCommandLine& line) {
    run::PlaybackSettings settings;
    settings.start = line.start.getValue();
    settings.count = line.count.getValue();
    settings.every = line.every.getValue();
    settings.imu = !line.noImu.getValue();
    settings.odometry = !line.noOdometry.getValue();
    settings.gnss = !line.noGnss.getValue();
    settings.fixes = line.gnss.getValue();
    if (line.antenna.isSet()) settings.antenna = antennaIn(line.antenna.getValue());
    settings.readAhead = line.threads.getValue() != 1;
    // A signal ends a live drive at its source: what was received is processed.
    if (!isLive(line)) settings.isInterrupted = cli::interrupted;
    return settings;
}

[[noreturn]] void failWithoutScans(SlamCommandLine& line, const std::string& input,
                                   const io::ScanReader& reader) {
    for (const auto& warning : run::warningsOfOthers(reader)) cli::warn(warning);
    const unsigned start = line.start.getValue();
    const std::string label = line.label.getValue();
    throw Error("'" + input + "' contains no LiDAR scans" +
                (label.empty() ? "" : " of sensor '" + label + "'") +
                (start > 0 ? " after --start " + std::to_string(start) : ""));
}

void play(SlamCommandLine& line, run::Playback& playback, run::Run& run, PoseOutput& poses) {
    cli::Progress progress("scans", line.count.getValue());
    std::size_t done = 0;
    playback.play(run, [&](const run::RunRow& row, const run::Playback::Progress& now) {
        poses.add(run, row, now);
        if (line.verbose.getValue()) cli::inform(describe(row));
        progress.update(++done, now.fraction);
    });
}

/** Poses of several sensors that --calibrate-extrinsics refines, which `source` gets. */
std::vector<run::CalibratedSensor> calibrated(SlamCommandLine& line, io::ScanSource& source) {
    if (!line.calibrateExtrinsics.isSet()) return {};
    const auto settings = playbackOf(line);
    const auto meta = io::openScans(source)->meta();
    cli::catchInterrupts();
    cli::Progress progress("calibrating, scans", line.count.getValue());
    std::size_t done = 0;
    auto sensors = run::calibrateExtrinsics(
        source, optionsFor(line, meta), settings,
        [&](std::optional<double> fraction) { progress.update(++done, fraction); });
    for (const auto& sensor : sensors) source.extrinsics[sensor.label] = sensor.pose;
    return sensors;
}

/** The reader of `source`; null where a signal ended a live drive before its first scan. */
std::unique_ptr<io::ScanReader> openInput(SlamCommandLine& line, const io::ScanSource& source) {
    if (!isLive(line)) return io::openScans(source);
    cli::catchInterrupts();  // the recorded packets are worth writing
    try {
        return io::openScans(source);
    } catch (const Error&) {
        if (!cli::interrupted()) throw;
        return nullptr;
    }
}

/** Finishes a run after its last scan and writes its results to `folder`, which is moved to `place`
 *  later. Returns what is missing, or an empty text. */
std::string finish(SlamCommandLine& line, const std::string& input, const std::string& folder,
                   const std::string& place, run::Run& run) {
    const auto& record = run.record();
    const bool anyUsed = record.predicted() < record.rows.size();
    if (!anyUsed)
        run.fail("no scan of '" + input + "' could be used: " + record.rows.front().reason);
    run.finish(record.fault.empty() && (isLive(line) || !cli::interrupted()));
    malloc_trim(0);  // pictures take a lot
    std::string fault = run::RunFolder(folder).write(record, anyUsed ? run.maps() : run::RunMaps{},
                                                     picture::illustrate);
    printTable(record, place, line.poses.isSet() ? std::cerr : std::cout);
    return fault;
}

/** The run of a drive, before its first scan. */
void prepare(SlamCommandLine& line, const io::ScanReader& reader, run::Run& run) {
    cli::inform("reading " + describe(reader.recording()));
    if (!reader.meta())
        run.warn(
            "unknown sensor model: no vertical correction is applied (normal unless this is KITTI "
            "data; see meta.md)");
    run.readSideFiles(reader.calibration(), reader.truth(), line.truth.getValue(),
                      line.truthFrame.getValue() == "cam0");
}

/** What --save-rawlog copies; throws Error where it cannot. */
std::optional<run::RawlogCopy> copyOf(SlamCommandLine& line, const std::string& input,
                                      const io::ScanReader& reader) {
    if (!line.saveRawlog.isSet()) return {};
    if (reader.recording().kind.rfind("rawlog", 0) != 0)
        throw Error("--save-rawlog copies a rawlog, which '" + input +
                    "' is not; convert it with scans2rawlog");
    const std::string label = reader.label().substr(0, reader.label().find(','));
    return run::RawlogCopy{input, line.saveRawlog.getValue(), label, line.images.getValue(),
                           reader.meta() ? reader.meta()->epoch_s : 0};
}

void saveCopy(const run::RunRecord& record, const run::RawlogCopy& copy) {
    const auto report = run::saveRawlog(record, copy);
    cli::inform("wrote '" + copy.output + "' with " + std::to_string(report.actions) + " actions");
    if (report.unmatched > 0)
        cli::warn(std::to_string(report.unmatched) + " scans have no action in '" + copy.output +
                  "': their stamps or turns differ from the rawlog's");
}

/** One drive, from `input` to the folder `settings.folder`; see SlamDrive. */
DriveResult slamDrive(SlamCommandLine& line, const std::string& input, run::RunSettings settings,
                      const std::string& place, LiveOutput& shown) {
    PoseOutput poses(line.poses.getValue(), line.publish.getValue());
    const std::string name = io::nameOfDrive(input);
    io::ScanSource source = sourceFor(line, input);
    const auto extrinsics = calibrated(line, source);
    auto reader = openInput(line, source);
    if (!reader) return {cli::kExitInterrupted};
    const Options options = optionsFor(line, reader->meta());
    run::Playback playback(*reader, playbackOf(line));
    if (playback.isEmpty() && !cli::interrupted()) failWithoutScans(line, input, *reader);
    cli::catchInterrupts();  // from here on there is something to write
    if (playback.isEmpty() || (cli::interrupted() && !isLive(line))) return {cli::kExitInterrupted};
    settings.sensorLabel = reader->label();
    settings.drive = name;
    run::Run run(options, settings);
    const auto copy = copyOf(line, input, *reader);
    prepare(line, *reader, run);
    run.add(extrinsics);
    shown.begin(run);
    play(line, playback, run, poses);
    shown.end();
    reader.reset();  // a live sensor's recording is written
    // Not even the first one: there is nothing to write.
    if (run.record().rows.empty()) throw Error(run.record().fault);
    const std::string fault = finish(line, input, settings.folder, place, run);
    if (copy) saveCopy(run.record(), *copy);
    if (!fault.empty()) throw Error(fault);
    if (cli::interrupted() && !isLive(line)) {
        cli::inform("interrupted; the results cover the first " +
                    std::to_string(run.record().rows.size()) + " scans");
        return {cli::kExitInterrupted, run.record().extended, false};
    }
    shown.waitForWindow();
    return {cli::kExitSuccess, run.record().extended, run.record().addedSubmaps > 0};
}

/** IN may be a pose graph: it is optimised again. */
int optimiseGraph(SlamCommandLine& line, const std::string& input,
                  const run::RunSettings& settings) {
    const auto record = run::optimiseAgain(io::loadG2o(input), optionsFor(line, {}), settings);
    const std::string fault =
        run::RunFolder(settings.folder).write(record, {}, picture::illustrate);
    if (!fault.empty()) throw Error(fault);
    printGraphTable(record, settings.folder, std::cout);
    return cli::kExitSuccess;
}

void refuseExisting(const std::string& file, SlamCommandLine& line) {
    const bool isThere = fs::exists(fs::symlink_status(file)) && !fs::is_character_file(file);
    if (isThere && !line.force.getValue())
        throw Error("'" + file + "' exists; overwrite it with --force");
}

/** Adds what --save-rawlog reads and writes, which may be there with --force only. */
void checkCopy(SlamCommandLine& line, std::vector<std::string>& read,
               std::vector<std::string>& written) {
    const auto inputs = cli::filesOfRawlog(line.input.getValue().front());
    read.insert(read.end(), inputs.begin(), inputs.end());
    for (const auto& file : run::filesOfCopy(line.saveRawlog.getValue())) {
        refuseExisting(file, line);
        written.push_back(file);
    }
}

/** Nothing that is read may be overwritten. */
void checkFolders(SlamCommandLine& line) {
    auto read = line.input.getValue();
    auto written = run::RunFolder(line.output.getValue()).files();
    const std::string map = line.map.isSet() ? run::storedMapIn(line.map.getValue()) : "";
    if (line.record.isSet()) {
        refuseExisting(line.record.getValue(), line);
        written.push_back(line.record.getValue());
    }
    if (read.size() > 1) written = filesOfSeveral(read, map, line.output.getValue());
    if (line.saveRawlog.isSet()) checkCopy(line, read, written);
    for (auto* file :
         {&line.truth, &line.sensorInfo, &line.extrinsics, &line.gnss, &line.vehicleBox})
        read.push_back(file->getValue());
    cli::refuseOverlap(read, written);
    if (map.empty()) return;
    std::error_code ignored;
    if (fs::equivalent(fs::absolute(map).parent_path(), line.output.getValue(), ignored))
        throw Error("the results would overwrite the map '" + line.map.getValue() +
                    "'; choose another output folder");
}

int slam(SlamCommandLine& line, int argc, char** argv) {
    try {
        optionsFor(line, {});
        if (line.initialPose.isSet()) initialPoseIn(line.initialPose.getValue());
        if (line.antenna.isSet()) antennaIn(line.antenna.getValue());
        if (line.vehicleBox.isSet()) io::vehiclePartsIn(line.vehicleBox.getValue());
        const std::string contradiction = contradictionIn(line);
        if (!contradiction.empty()) throw Error(contradiction);
    } catch (const Error& e) {
        cli::inform(e.what());
        return cli::kExitBadCommandLine;
    }
    if (line.printConfig.getValue()) {
        printConfig(line);
        return cli::kExitSuccess;
    }
    const unsigned threads = line.threads.getValue();
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      threads > 0 ? threads : std::thread::hardware_concurrency());
    const auto& inputs = line.input.getValue();
    for (const auto& input : inputs)
        if (input != "-" && !io::isLive(input) && !fs::exists(input))
            throw Error("cannot read '" + input + "': no such file or folder");
    if (line.gnss.isSet() && !fs::exists(line.gnss.getValue()))
        throw Error("cannot read '" + line.gnss.getValue() + "': no such file");
    checkFolders(line);
    LiveOutput shown(line);
    const OutputFolder folder(line.output.getValue(), line.force.getValue());
    const auto settings = settingsFor(line, argc, argv);
    if (inputs.size() > 1)
        return slamSeveral(inputs, settings,
                           [&](const auto& input, const auto& its, const auto& place) {
                               return slamDrive(line, input, its, place, shown);
                           });
    if (inputs.front() == "-") cli::endInputAtInterrupt();
    return isGraph(inputs.front())
               ? optimiseGraph(line, inputs.front(), settings)
               : slamDrive(line, inputs.front(), settings, settings.folder, shown).exitCode;
}
}  // namespace

int main(int argc, char** argv) {
    // One heap for all threads; large blocks go back to the system when they are freed.
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_THRESHOLD, 8 << 20);
    mallopt(M_TRIM_THRESHOLD, 384 << 20);
    const bool runs = std::none_of(
        argv, argv + argc, [](const char* word) { return std::string(word) == "--print-config"; });
    SlamCommandLine line(runs);
    const int exitCode = cli::run(line.cmd, slamHelp(), argc, argv, line.verbose,
                                  [&] { return slam(line, argc, argv); });
    if (line.gui.getValue()) {
        // All is written. MRPT 2.5.8's window thread crashes now and then when the program's end
        // takes its objects away from under it, so they stay.
        std::cout.flush();
        std::_Exit(exitCode);
    }
    return exitCode;
}
