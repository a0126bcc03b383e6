// delio-slam: a recording in; trajectory, pose graph, map, scene and pictures out.
#include <malloc.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <iostream>
#include <thread>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/formats/fixes.h"
#include "delio/formats/g2o.h"
#include "delio/picture/figures.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run_folder.h"
#include "initial_pose.h"
#include "live_view.h"
#include "output_folder.h"
#include "overlap.h"
#include "run_table.h"
#include "several_drives.h"
#include "slam_command_line.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

struct Reading {
    std::optional<Scan> scan;    //!< nothing at the end
    std::vector<ImuSample> imu;  //!< that were read with it
    std::optional<double> fraction;
};

/** The next scan after some that are passed over; nothing at the end, and after Ctrl-C. */
Reading read(io::ScanReader& reader, std::size_t passedOver) {
    for (std::size_t i = 0; i < passedOver; ++i) {
        if (cli::interrupted()) return {};
        if (!reader.skip()) break;
    }
    auto scan = reader.next();
    return {std::move(scan), reader.takeImu(), reader.fraction()};
}

void warnOfOthers(const io::ScanReader& reader,
                  const std::function<void(const std::string&)>& warn) {
    for (const auto& other : reader.otherLabels())
        warn("scans of the sensor '" + other +
             "' are ignored; choose a sensor with --sensor-label");
}

/** Adds the fixes of --gnss or of the recording. Those of a recording may be missing or damaged. */
void addFixes(SlamCommandLine& line, io::ScanReader& reader, run::Run& run) {
    if (line.noGnss.getValue()) return;
    try {
        auto fixes = reader.takeFixes();
        if (line.gnss.isSet()) fixes = io::readFixes(line.gnss.getValue());
        const double epoch_s = reader.meta() ? reader.meta()->epoch_s : 0;
        if (line.gnss.isSet()) io::countFrom(epoch_s, fixes);
        if (line.antenna.isSet())
            for (auto& fix : fixes) fix.antenna = antennaIn(line.antenna.getValue());
        run.add(fixes);
    } catch (const Error& e) {
        const std::string what = "the GNSS fixes cannot be used: " + std::string(e.what());
        line.gnss.isSet() ? run.fail(what) : run.warn(what);
    }
}

/** Processes scans until the end, --count, an interrupt or a fault in the recording. With several
 *  threads the next scan is read while this one is registered; `read_ms` is the waiting time. */
void process(SlamCommandLine& line, Reading now, io::ScanReader& reader, double read_ms,
             run::Run& run) {
    const unsigned count = line.count.getValue(), passedOver = line.every.getValue() - 1;
    const auto policy = line.threads.getValue() == 1 ? std::launch::deferred : std::launch::async;
    cli::Progress progress("scans", count);
    try {
        for (std::size_t done = 1; now.scan; ++done) {
            // Do not read beyond the last scan: a fault there does not matter.
            std::future<Reading> next;
            if (done != count) next = std::async(policy, [&] { return read(reader, passedOver); });
            if (!line.noImu.getValue())
                for (const auto& sample : now.imu) run.addImu(sample);
            const auto row = run.process(*now.scan, read_ms);
            if (line.verbose.getValue()) cli::inform(describe(row));
            progress.update(done, now.fraction);
            if (cli::interrupted() || done == count) break;
            Stopwatch watch;
            now = next.get();
            read_ms = watch.lap_ms();
        }
    } catch (const std::exception& e) {
        // Ctrl-C ends standard input anywhere within a scan.
        if (!cli::interrupted()) run.fail(plainMessage(e));
    }
    warnOfOthers(reader, [&](const std::string& text) { run.warn(text); });
    addFixes(line, reader, run);
    const auto recording = reader.recording();
    for (const auto& finding : recording.findings) run.warn(finding);
    if (const auto scan = recording.compensatedAfterAll)
        run.warn("from scan " + std::to_string(*scan) +
                 " on, the points look de-skewed by the recorder, unlike before; run again with "
                 "--set scan.deskew=false");
}

std::shared_ptr<LiveView> liveViewFor(SlamCommandLine& line, const Options& options,
                                      run::Run& run) {
    if (!line.gui.getValue()) return nullptr;
    auto view = std::make_shared<LiveView>(options.paper);
    run.attach(view);
    return view;
}

/** The first scan to use. Throws Error if there is no such scan. */
Reading firstOf(SlamCommandLine& line, const std::string& input, io::ScanReader& reader) {
    const unsigned start = line.start.getValue();
    auto first = read(reader, start);
    if (first.scan || cli::interrupted()) return first;
    warnOfOthers(reader, cli::warn);
    const std::string label = line.label.getValue();
    throw Error("'" + input + "' contains no LiDAR scans" +
                (label.empty() ? "" : " of sensor '" + label + "'") +
                (start > 0 ? " after --start " + std::to_string(start) : ""));
}

void warnOfRecording(const io::ScanReader& reader, run::Run& run) {
    for (const auto& warning : reader.recording().warnings) run.warn(warning);
    if (!reader.meta())
        run.warn(
            "unknown sensor model: no vertical correction is applied (normal unless this is KITTI "
            "data; see meta.md)");
}

/** Finishes a run after its last scan and writes its results to `folder`, which is moved to `place`
 *  later. Returns what is missing, or an empty text. */
std::string finish(const std::string& input, const std::string& folder, const std::string& place,
                   run::Run& run) {
    const auto& record = run.record();
    const bool anyUsed = record.predicted() < record.rows.size();
    if (!anyUsed)
        run.fail("no scan of '" + input + "' could be used: " + record.rows.front().reason);
    run.finish(record.fault.empty() && !cli::interrupted());
    malloc_trim(0);  // pictures take a lot
    std::string fault = run::RunFolder(folder).write(record, anyUsed ? run.maps() : run::RunMaps{},
                                                     picture::illustrate);
    printTable(record, place, std::cout);
    return fault;
}

/** One drive, from `input` to the folder `settings.folder`; see SlamDrive. */
DriveResult slamDrive(SlamCommandLine& line, const std::string& input, run::RunSettings settings,
                      const std::string& place) {
    Stopwatch watch;
    const std::string name = io::nameOfDrive(input);
    const auto reader = io::openScans(sourceFor(line, input));
    const Options options = optionsFor(line, reader->meta());
    auto first = firstOf(line, input, *reader);
    const double read_ms = watch.lap_ms();
    cli::catchInterrupts();  // from here on there is something to write
    if (cli::interrupted()) return {cli::kExitInterrupted};
    settings.sensorLabel = reader->label();
    settings.drive = name;
    cli::inform("reading " + describe(reader->recording()));
    run::Run run(options, settings);
    warnOfRecording(*reader, run);
    run.readSideFiles(reader->calibration(), reader->truth(), line.truth.getValue(),
                      line.truthFrame.getValue() == "cam0");
    const auto view = liveViewFor(line, options, run);
    process(line, std::move(first), *reader, read_ms, run);
    // Not even the first one: there is nothing to write.
    if (run.record().rows.empty()) throw Error(run.record().fault);
    const std::string fault = finish(input, settings.folder, place, run);
    if (!fault.empty()) throw Error(fault);
    if (cli::interrupted()) {
        cli::inform("interrupted; the results cover the first " +
                    std::to_string(run.record().rows.size()) + " scans");
        return {cli::kExitInterrupted, run.record().extended, false};
    }
    if (view && view->isOpen()) cli::inform("done; close the window to end");
    while (view && view->isOpen() && !cli::interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
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

/** Nothing that is read may be overwritten. */
void checkFolders(SlamCommandLine& line) {
    auto read = line.input.getValue();
    auto written = run::RunFolder(line.output.getValue()).files();
    const std::string map = line.map.isSet() ? run::storedMapIn(line.map.getValue()) : "";
    if (read.size() > 1) written = filesOfSeveral(read, map, line.output.getValue());
    for (auto* file : {&line.truth, &line.sensorInfo, &line.gnss}) read.push_back(file->getValue());
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
        if (input != "-" && !fs::exists(input))
            throw Error("cannot read '" + input + "': no such file or folder");
    checkFolders(line);
    const OutputFolder folder(line.output.getValue(), line.force.getValue());
    const auto settings = settingsFor(line, argc, argv);
    if (inputs.size() > 1)
        return slamSeveral(inputs, settings,
                           [&](const auto& input, const auto& its, const auto& place) {
                               return slamDrive(line, input, its, place);
                           });
    if (inputs.front() == "-") cli::endInputAtInterrupt();
    return isGraph(inputs.front())
               ? optimiseGraph(line, inputs.front(), settings)
               : slamDrive(line, inputs.front(), settings, settings.folder).exitCode;
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
