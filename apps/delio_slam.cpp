// delio-slam: a rawlog in; trajectory, pose graph, map, scene and pictures out.
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/system/CTicTac.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include "cli.h"
#include "delio/error.h"
#include "delio/graph/graph_file.h"
#include "delio/io/drive_meta.h"
#include "delio/io/scan_source.h"
#include "delio/profile.h"
#include "delio/slam.h"
#include "delio/version.h"
#include "live_view.h"
#include "slam_outputs.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

/** What the command line asked for. */
struct Request {
    std::string input, output, profile, configText, label, images, truth, truthFrame;
    std::vector<std::string> assignments;
    std::size_t start = 0, count = 0, every = 1;
    bool withMap = true, withGraph = true, withView = false, verbose = false;
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
Options optionsFor(const Request& request, const std::optional<io::DriveMeta>& meta) {
    Options options = Options::ofProfile(request.profile);
    if (meta) options.adaptTo(*meta);
    options.load(request.configText);
    for (const auto& assignment : request.assignments) options.set(assignment);
    return options;
}

/** The folder is made at once, so that an unwritable one is found before the work is done; one that
 *  was made for nothing is taken away again. */
class OutputFolder {
 public:
    OutputFolder(const std::string& folder, bool force);
    ~OutputFolder() {
        std::error_code ignored;
        if (made_) fs::remove(folder_, ignored);  // only an empty one
    }
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

 private:
    std::string folder_;
    bool made_ = false;
};

OutputFolder::OutputFolder(const std::string& folder, bool force) : folder_(folder) {
    std::error_code fault;
    if (fs::exists(folder) && !fs::is_directory(folder))
        throw Error("'" + folder + "' exists and is no folder; choose another name");
    if (fs::exists(folder) && !fs::is_empty(folder, fault)) cli::refuseExisting(folder, force);
    made_ = fs::create_directories(folder, fault);
    const fs::path probe = fs::path(folder) / ".partial-probe";
    const bool writable = !fault && std::ofstream(probe).put('x').good();
    fs::remove(probe, fault);
    if (!writable) throw Error("cannot write into the folder '" + folder + "'");
}

/** Scans into `slam` until the end, the wanted count, an interrupt or a fault in the rawlog. */
void process(const Request& request, io::ScanSource& source, std::optional<Slam>& slam,
             const Options& options, SlamRun& run, std::optional<LiveView>& view) {
    cli::Progress progress("scans", request.count);
    try {
        for (std::size_t i = 0; i < request.start; ++i)
            if (!source.skip()) break;
        while (!cli::interrupted() && (request.count == 0 || run.reports.size() < request.count)) {
            mrpt::system::CTicTac clock;
            const auto scan = source.next();
            if (!scan) break;
            const double read_ms = 1e3 * clock.Tac();
            if (!slam)
                slam.emplace(options, request.withGraph, request.withMap, source.label(),
                             request.output);
            const ScanReport report = slam->process(*scan);
            run.addScan(*scan, report, read_ms);
            if (view)
                view->show(*scan, report.odometry.increment.pose, slam->odometry().poses.back());
            if (request.verbose) cli::inform(run.describeLastScan());
            progress.update(run.reports.size(), source.fraction());
            for (std::size_t i = 1; i < request.every; ++i)
                if (!source.skip()) break;
        }
    } catch (const std::exception& e) {
        run.fault = plainMessage(e);
    }
    for (const auto& other : source.otherLabels())
        run.warn("scans of sensor '" + other + "' were not used; see --sensor-label");
}

int slamRawlog(const Request& request, SlamRun& run) {
    const auto meta = io::readDriveMeta(request.input);
    if (!meta && fs::exists(request.input))
        run.warn("no '" + io::sidecarPath(request.input, ".meta.yaml") +
                 "': no vertical correction, times are Unix seconds");
    const Options options = optionsFor(request, meta);
    run.readSideFiles(request.input, request.truth, request.truthFrame);
    io::ScanSource source(request.input, request.label, request.images, meta ? meta->epoch_s : 0);
    std::optional<Slam> slam;
    std::optional<LiveView> view;
    if (request.withView) view.emplace(options.odometry);
    process(request, source, slam, options, run, view);
    if (!slam) {
        if (cli::interrupted()) return cli::kExitInterrupted;
        if (!run.fault.empty()) throw Error(run.fault);
        throw Error("'" + request.input + "' holds no LiDAR scans" +
                    (request.label.empty() ? "" : " of sensor '" + request.label + "'") +
                    (request.start > 0 ? " after --start " + std::to_string(request.start) : ""));
    }
    const bool anyUsed = std::any_of(run.reports.begin(), run.reports.end(),
                                     [](const auto& r) { return !r.odometry.predicted; });
    if (!anyUsed && run.fault.empty())
        run.fault = "no scan of '" + request.input +
                    "' could be used: " + run.reports.front().odometry.reason;
    run.complete = run.fault.empty() && !cli::interrupted();
    run.optimise(*slam);
    run.write(*slam, options, request.withMap && anyUsed);
    run.printTable(std::cout);
    if (!run.fault.empty()) throw Error(run.fault);
    if (cli::interrupted()) return cli::kExitInterrupted;
    if (view && view->isOpen()) cli::inform("done; close the window to end");
    while (view && view->isOpen() && !cli::interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return cli::kExitSuccess;
}

/** IN may be a pose graph: it is optimised again. */
int optimiseGraph(const Request& request, SlamRun& run) {
    const Options options = optionsFor(request, {});
    auto graph = graph::loadG2o(request.input);
    run.complete = true;
    run.optimiseAndWrite(graph, options);
    if (!run.fault.empty()) throw Error(run.fault);
    return cli::kExitSuccess;
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("delio-slam: LiDAR odometry, pose graph and map of a rawlog", ' ', kVersion);
    using Text = TCLAP::ValueArg<std::string>;
    using Number = TCLAP::ValueArg<cli::Count>;
    Text input("i", "input", "Rawlog to read, or a posegraph.g2o to optimise again", true, "",
               "IN.rawlog", cmd);
    Text output("o", "output", "Folder for the results", true, "", "OUTDIR", cmd);
    Text profile("", "profile", "accurate, paper or paper-literal", false, "accurate", "NAME", cmd);
    Text config("c", "config", "Options that differ from the profile's", false, "", "CONFIG.ini",
                cmd);
    TCLAP::MultiArg<std::string> set("", "set", "One option; may be repeated", false,
                                     "section.key=value", cmd);
    Number start("", "start", "First scan, from 0", false, {}, "N", cmd);
    Number count("", "count", "How many scans to use at most; 0: all", false, {}, "N", cmd);
    Number every("", "every", "Use every N-th scan only", false, {1}, "N", cmd);
    Text label("", "sensor-label", "Sensor to use; default: that of the first scan", false, "", "L",
               cmd);
    Text images("", "images", "Folder of the rawlog's external files", false, "", "DIR", cmd);
    Number threads("", "threads", "Threads to use; 0: all", false, {}, "N", cmd);
    Text truth("", "ground-truth", "True poses; default: IN.poses.txt if it is there", false, "",
               "POSES.txt", cmd);
    std::vector<std::string> frames = {"cam0", "vehicle"};
    TCLAP::ValuesConstraint<std::string> frameNames(frames);
    TCLAP::ValueArg<std::string> truthFrame("", "ground-truth-frame", "Frame of the true poses",
                                            false, "cam0", &frameNames, cmd);
    TCLAP::SwitchArg noMap("", "no-map", "Leave out map, scene and map.png", cmd);
    TCLAP::SwitchArg noGraph("", "no-graph", "Leave out the pose graph's optimisation", cmd);
    TCLAP::SwitchArg gui("", "gui", "Show the drive in a window while it is processed", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite what exists", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "A line for each scan, and all the text of errors",
                             cmd);

    const int exitCode = cli::run(cmd, argc, argv, verbose, [&] {
        cli::catchInterrupts();
        Request request;
        request.input = input.getValue();
        request.output = output.getValue();
        request.profile = profile.getValue();
        request.label = label.getValue();
        request.images = images.getValue();
        request.truth = truth.getValue();
        request.truthFrame = truthFrame.getValue();
        request.assignments = set.getValue();
        request.start = start.getValue();
        request.count = count.getValue();
        request.every = every.getValue();
        request.withMap = !noMap.getValue();
        request.withGraph = !noGraph.getValue();
        request.withView = gui.getValue();
        request.verbose = verbose.getValue();
        try {
            if (config.isSet()) request.configText = textOf(config.getValue());
            optionsFor(request, {});
            if (request.every == 0) throw Error("--every has to be 1 or more");
        } catch (const Error& e) {
            cli::inform(e.what());
            return cli::kExitBadCommandLine;
        }
        const unsigned wanted =
            threads.getValue() > 0 ? threads.getValue() : std::thread::hardware_concurrency();
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, wanted);
        if (!fs::is_regular_file(request.input))
            throw Error("cannot read '" + request.input +
                        "': " + (fs::exists(request.input) ? "it is no file" : "no such file"));
        const OutputFolder folder(request.output, force.getValue());
        SlamRun run(request.output, request.profile, std::vector<std::string>(argv, argv + argc));
        if (fs::path(request.input).extension() == ".g2o") return optimiseGraph(request, run);
        return slamRawlog(request, run);
    });
    if (gui.getValue()) {
        // All is written. MRPT 2.5.8's window thread crashes now and then when the program's end
        // takes its objects away from under it, so they stay.
        std::cout.flush();
        std::_Exit(exitCode);
    }
    return exitCode;
}
