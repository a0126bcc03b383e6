#include "delio/run/run.h"

#include <exception>
#include <utility>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/picture/figures.h"
#include "delio/run/playback.h"
#include "delio/run/run_folder.h"
#include "overlap.h"

namespace delio::python {
namespace fs = std::filesystem;

namespace {
/** Arguments of run() besides the profile and its options. */
struct RunArguments {
    fs::path input, output;
    run::PlaybackSettings playback;
    std::string truthFrame;
    std::string truth;
    bool pictures = true, force = false;
    py::object progress;
};

/** Calls `progress`, and sees to Ctrl-C. Throws what Python raises. */
void report(const py::object& progress, std::size_t done) {
    const py::gil_scoped_acquire acquire;
    if (!progress.is_none()) progress(done);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void checkOutput(const RunArguments& arguments, const run::RunSettings& settings) {
    if (arguments.playback.every == 0) throw Error("'every' must be at least 1");
    if (arguments.truthFrame != "cam0" && arguments.truthFrame != "vehicle")
        throw Error("'ground_truth_frame' must be 'cam0' or 'vehicle'");
    const run::RunFolder folder(settings.folder);
    cli::refuseOverlap({arguments.input.string(), arguments.truth, settings.storedMap},
                       folder.files());
    std::error_code ignored;
    if (!arguments.force && fs::exists(arguments.output) &&
        !fs::is_empty(arguments.output, ignored))
        throw Error("'" + settings.folder +
                    "' exists and is not empty; choose another folder or give force=True");
}

/** The record of a drive whose results are written. */
run::RunRecord runDrive(const RunArguments& arguments, io::ScanReader& reader,
                        const Options& options, const run::RunSettings& runSettings) {
    std::exception_ptr raised;  // by Python
    auto settings = arguments.playback;
    settings.isInterrupted = [&] { return raised != nullptr; };
    run::Playback playback(reader, settings);
    if (playback.isEmpty())
        throw Error("'" + arguments.input.string() + "' contains no LiDAR scans there");
    run::Run run(options, runSettings);
    run.readSideFiles(reader.calibration(), reader.truth(), arguments.truth,
                      arguments.truthFrame == "cam0");
    std::size_t done = 0;
    playback.play(run, [&](const auto& /*row*/, const auto& /*progress*/) {
        try {
            report(arguments.progress, ++done);
        } catch (const py::error_already_set&) {
            raised = std::current_exception();
        }
    });
    if (run.record().rows.empty()) throw Error(run.record().fault);
    run.finish(!raised && run.record().fault.empty());
    const std::string fault =
        run::RunFolder(runSettings.folder)
            .write(run.record(), run.maps(),
                   arguments.pictures ? picture::illustrate : run::Illustrate{});
    if (raised) std::rethrow_exception(raised);
    if (!fault.empty()) throw Error(fault);
    return run.record();
}

using RecordClass = py::class_<run::RunRecord>;

void bindResult(py::module_& module) {
    RecordClass(module, "RunResult", "Result of run(); all of it is in the output folder, too.")
        .def_property_readonly(
            "poses", [](const run::RunRecord& of) { return arrayOf(of.final.poses); },
            "(N, 4, 4): final poses; they map the vehicle's coordinates to those at the first "
            "scan, "
            "or to the stored map's; metres.")
        .def_property_readonly(
            "odometry_poses", [](const run::RunRecord& of) { return arrayOf(of.odometry.poses); },
            "(N, 4, 4): poses before the pose graph.")
        .def_property_readonly(
            "stamps", [](const run::RunRecord& of) { return arrayOf(of.odometry.stamps_s); },
            "(N,): seconds.")
        .def_property_readonly(
            "predicted", [](const run::RunRecord& of) { return of.predicted(); },
            "Number of scans that were not registered.")
        .def_property_readonly(
            "loops", [](const run::RunRecord& of) { return of.closedLoops(); },
            "Closed loops, a list of pairs of scans, the earlier one first.")
        .def_property_readonly(
            "path_m", [](const run::RunRecord& of) { return of.path_m(); },
            "m; length of the trajectory.")
        .def_property_readonly(
            "metrics", [](const run::RunRecord& of) { return of.metrics; },
            "Metrics beside the ground truth; None where there is none.")
        .def_readonly("warnings", &run::RunRecord::warnings, "A list of lines.");
}

constexpr const char* kRunText =
    R"(Computes trajectory and map of a recording, as `delio-slam -i input -o output`.

Files in `output` have the same bytes as those of delio-slam, except for times and the command line
in scans.csv and summary.yaml. Returns a RunResult.

start, count, every: first scan, number of scans (0: all), every n-th scan.
sensor_label, sensor_file, images, extrinsics, vehicle_box: as of open_scans().
ground_truth: pose file; empty: that of the recording. ground_truth_frame: 'cam0' or 'vehicle'.
map: a stored map in which the drive is localised; initial_pose: (4, 4) of the vehicle at the first
    scan in it, if known; extend: add the drive to it.
loops, graph, build_map: False leaves them out. keep_dynamic: write map_dynamic.ply.
pictures: False leaves them out.
force: overwrite existing files.
imu, odometry, gnss: False leaves the recording's IMU, wheel odometry or GNSS fixes out. fixes: a
    file (csv or NMEA) that replaces the recording's fixes; antenna: (3,), position of the GNSS antenna in the vehicle,
    metres.
progress: called with the number of processed scans. Ctrl-C, and what it raises, end the run; the
    results up to there are written.
options: section__key=value, as of Odometry.
Raises delio.Error as delio-slam fails.)";

run::RunRecord runOf(const RunArguments& arguments, const std::string& profile,
                     const io::ScanSource& source, run::RunSettings settings,
                     const py::object& initialPose, const py::kwargs& options) {
    settings.profile = profile;
    settings.command = {"delio.run"};
    settings.folder = arguments.output.string();
    if (!initialPose.is_none()) settings.initialPose = poseIn(initialPose, "initial_pose");
    if (settings.storedMap.empty() && (settings.extend || settings.initialPose))
        throw Error("'extend' and 'initial_pose' need 'map', a stored map");
    checkOutput(arguments, settings);
    Scans scans{source.path, io::openScans(source), {}};
    settings.sensorLabel = scans.in->label();
    settings.drive = io::nameOfDrive(source.path);
    const auto all =
        optionsOf(profile, py::cast(&scans, py::return_value_policy::reference), options);
    const py::gil_scoped_release release;
    return runDrive(arguments, *scans.in, all, settings);
}
}  // namespace

void bindRun(py::module_& module) {
    bindResult(module);
    module.def(
        "run",
        [](const fs::path& input, const fs::path& output, const std::string& profile,
           std::size_t start, std::size_t count, std::size_t every, const std::string& label,
           const OptionalPath& sensorFile, const OptionalPath& images, const OptionalPath& truth,
           const std::string& truthFrame, const OptionalPath& map, const py::object& initialPose,
           bool extend, bool loops, bool graph, bool buildMap, bool keepDynamic, bool pictures,
           bool force, bool imu, bool odometry, bool gnss, const OptionalPath& fixes,
           const py::object& antenna, const OptionalPath& extrinsics, const py::object& vehicleBox,
           const py::object& progress, const py::kwargs& options) {
            run::PlaybackSettings playback;
            playback.start = start;
            playback.count = count;
            playback.every = every;
            playback.imu = imu;
            playback.odometry = odometry;
            playback.gnss = gnss;
            playback.fixes = textOf(fixes);
            if (!antenna.is_none()) playback.antenna = vectorIn(antenna, "antenna");
            run::RunSettings settings;
            settings.storedMap = textOf(map);
            settings.extend = extend;
            settings.loops = loops;
            settings.graph = graph;
            settings.map = buildMap;
            settings.keepDynamic = keepDynamic;
            settings.gnss = gnss;
            io::ScanSource source{input.string(), label, textOf(images), textOf(sensorFile)};
            source.extrinsicsFile = textOf(extrinsics);
            source.vehicle = vehicleIn(vehicleBox);
            return runOf(
                {input, output, playback, truthFrame, textOf(truth), pictures, force, progress},
                profile, source, settings, initialPose, options);
        },
        py::arg("input"), py::arg("output"), py::arg("profile") = "accurate", py::kw_only(),
        py::arg("start") = 0, py::arg("count") = 0, py::arg("every") = 1,
        py::arg("sensor_label") = "", py::arg("sensor_file") = py::none(),
        py::arg("images") = py::none(), py::arg("ground_truth") = py::none(),
        py::arg("ground_truth_frame") = "cam0", py::arg("map") = py::none(),
        py::arg("initial_pose") = py::none(), py::arg("extend") = false, py::arg("loops") = true,
        py::arg("graph") = true, py::arg("build_map") = true, py::arg("keep_dynamic") = false,
        py::arg("pictures") = true, py::arg("force") = false, py::arg("imu") = true,
        py::arg("odometry") = true, py::arg("gnss") = true, py::arg("fixes") = py::none(),
        py::arg("antenna") = py::none(), py::arg("extrinsics") = py::none(),
        py::arg("vehicle_box") = py::none(), py::arg("progress") = py::none(), kRunText);
}
}  // namespace delio::python
